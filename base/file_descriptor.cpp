#include "base/file_descriptor.h"

#include <algorithm>
#include <cerrno>
#include <cstring>

#include <fcntl.h>
#include <linux/magic.h>
#include <poll.h>
#include <sys/stat.h>
#include <sys/vfs.h>
#include <unistd.h>

namespace kelpie {

namespace {

/// Nothing is waited for, and no terminal becomes ours.
constexpr int k_open_flags = O_CLOEXEC | O_NONBLOCK | O_NOCTTY;

/// A pipe without a name in any folder, which another program opened for us.
bool is_handed_over(int file) {
  struct statfs system {};
  return fstatfs(file, &system) == 0 && system.f_type == PIPEFS_MAGIC;
}

/// What is not to be used as a file, in words.
std::string kind_of(mode_t mode) {
  if (S_ISFIFO(mode)) return "it is a named pipe, not a file";
  if (S_ISSOCK(mode)) return "it is a socket, not a file";
  if (S_ISDIR(mode)) return std::strerror(EISDIR);
  return "it is a device, not a file";
}

void wait_until(int file, short event) noexcept {
  pollfd ready{file, event, 0};
  poll(&ready, 1, -1);
}

} // namespace

FileDescriptor::~FileDescriptor() { close(); }

int FileDescriptor::close() noexcept {
  if (number_ < 0) return 0;
  return ::close(std::exchange(number_, -1)) == 0 ? 0 : errno;
}

FileDescriptor open_to_read(const std::string& path, std::string& why) {
  FileDescriptor file(open(path.c_str(), O_RDONLY | k_open_flags));
  struct stat status {};
  if (!file.is_open() || fstat(file.number(), &status) != 0) {
    why = std::strerror(errno);
    return {};
  }
  const bool is_pipe = S_ISFIFO(status.st_mode) && is_handed_over(file.number());
  if (!S_ISREG(status.st_mode) && !is_pipe) why = kind_of(status.st_mode);
  return file;
}

FileDescriptor open_to_write_in_place(const std::string& path, std::string& why) {
  struct stat status {};
  if (stat(path.c_str(), &status) == 0 && !S_ISCHR(status.st_mode) && !S_ISFIFO(status.st_mode)) {
    why = kind_of(status.st_mode);
    return {};
  }
  FileDescriptor file(open(path.c_str(), O_WRONLY | k_open_flags));
  const bool is_named_pipe = S_ISFIFO(status.st_mode) && !(file.is_open() && is_handed_over(file.number()));
  if (is_named_pipe)
    why = kind_of(status.st_mode);
  else if (!file.is_open())
    why = std::strerror(errno);
  return why.empty() ? std::move(file) : FileDescriptor();
}

int write_fully(int file, std::span<const unsigned char> bytes) noexcept {
  while (!bytes.empty()) {
    const ssize_t n = ::write(file, bytes.data(), std::min<size_t>(bytes.size(), size_t(1) << 30));
    if (n < 0 && errno == EINTR) continue;
    if (n < 0 && errno == EAGAIN) {
      wait_until(file, POLLOUT);
      continue;
    }
    if (n <= 0) return n < 0 ? errno : ENOSPC;
    bytes = bytes.subspan(static_cast<size_t>(n));
  }
  return 0;
}

long read_some(int file, char* bytes, size_t size) noexcept {
  for (;;) {
    const ssize_t n = ::read(file, bytes, size);
    if (n >= 0 || (errno != EINTR && errno != EAGAIN)) return n;
    if (errno == EAGAIN) wait_until(file, POLLIN);
  }
}

} // namespace kelpie
