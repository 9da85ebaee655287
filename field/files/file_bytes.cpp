#include "field/files/file_bytes.h"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <memory>

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include "base/error.h"

namespace kelpie {

namespace {

[[noreturn]] void fail(ExitStatus status, const char* what, const std::string& path, int code) {
  throw Error(status, fmt::format("{}: {}", what, std::strerror(code)), {path, 0, 0});
}

/// A file descriptor that closes itself.
class Descriptor {
public:
  explicit Descriptor(int fd) : fd_(fd) {}
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  ~Descriptor() {
    if (fd_ >= 0) ::close(fd_);
  }
  int get() const { return fd_; }
  /// Closes now; false where the last bytes could not be kept.
  bool close() {
    const int fd = fd_;
    fd_ = -1;
    return ::close(fd) == 0;
  }

private:
  int fd_;
};

/// 0, or the error's number.
int write_and_sync(const std::string& path, std::string_view bytes) {
  Descriptor file(::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666));
  if (file.get() < 0) return errno;
  while (!bytes.empty()) {
    const ssize_t n = ::write(file.get(), bytes.data(), bytes.size());
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) return errno;
    bytes.remove_prefix(static_cast<size_t>(n));
  }
  if (::fsync(file.get()) != 0) return errno;
  return file.close() ? 0 : errno;
}

} // namespace

std::string read_file_bytes(const std::string& path) {
  if (std::error_code ignored; std::filesystem::is_directory(path, ignored)) fail(ExitStatus::missing_input, "cannot read", path, EISDIR);
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "rb"), &std::fclose);
  if (!file) fail(ExitStatus::missing_input, "cannot read", path, errno);
  std::string bytes;
  char buffer[1 << 16];
  while (const size_t n = std::fread(buffer, 1, sizeof buffer, file.get())) bytes.append(buffer, n);
  if (std::ferror(file.get())) fail(ExitStatus::missing_input, "cannot read", path, errno);
  return bytes;
}

void write_file_bytes(const std::string& path, std::string_view bytes) {
  namespace fs = std::filesystem;
  const fs::path target(path), folder = target.has_parent_path() ? target.parent_path() : fs::path(".");
  // The process's number keeps two writers of one file apart.
  const std::string part = (folder / fmt::format(".{}.{}.part", target.filename().string(), ::getpid())).string();
  int code = write_and_sync(part, bytes);
  if (code == 0 && std::rename(part.c_str(), path.c_str()) != 0) code = errno;
  if (code != 0) {
    ::unlink(part.c_str());
    fail(ExitStatus::cannot_write, "cannot write", path, code);
  }
  const Descriptor parent(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)); // the new name must survive as well
  if (parent.get() >= 0) ::fsync(parent.get());
}

} // namespace kelpie
