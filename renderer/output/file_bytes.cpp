#include "renderer/output/file_bytes.h"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>

#include <sys/stat.h>

#include <fmt/format.h>

#include "base/error.h"

namespace kelpie {

std::vector<unsigned char> read_file_bytes(const std::string& path) {
  const auto fail = [&](const char* why) { throw Error(ExitStatus::missing_input, fmt::format("{}: {}", path, why)); };
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "rb"), std::fclose);
  if (!file) fail(std::strerror(errno));
  struct stat status {};
  if (fstat(fileno(file.get()), &status) == 0 && S_ISDIR(status.st_mode)) fail("is a folder");
  std::vector<unsigned char> bytes(S_ISREG(status.st_mode) ? static_cast<size_t>(status.st_size) : 0);
  const size_t n = bytes.empty() ? 0 : std::fread(bytes.data(), 1, bytes.size(), file.get());
  if (n != bytes.size() || std::ferror(file.get())) fail("cannot be read whole");
  unsigned char more[65536]; // a pipe, or a file that grew
  while (const size_t m = std::fread(more, 1, sizeof more, file.get())) bytes.insert(bytes.end(), more, more + m);
  return bytes;
}

} // namespace kelpie
