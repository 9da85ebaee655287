#include "base/file_bytes.h"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <memory>

#include <fmt/format.h>

#include "base/error.h"

namespace kelpie {

std::string read_file_bytes(const std::string& path) {
  const auto fail = [&](int code) {
    throw Error(ExitStatus::missing_input, fmt::format("cannot read: {}", std::strerror(code)), {path, 0, 0});
  };
  if (std::error_code ignored; std::filesystem::is_directory(path, ignored)) fail(EISDIR);
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "rb"), &std::fclose);
  if (!file) fail(errno);
  std::string bytes;
  char buffer[1 << 16];
  while (const size_t n = std::fread(buffer, 1, sizeof buffer, file.get())) bytes.append(buffer, n);
  if (std::ferror(file.get())) fail(errno);
  return bytes;
}

} // namespace kelpie
