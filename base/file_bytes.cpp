#include "base/file_bytes.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <memory>

#include <fmt/format.h>

#include "base/error.h"
#include "base/file_descriptor.h"

namespace kelpie {

std::string read_file_bytes(const std::string& path, const ReadLimits& limits) {
  const auto fail = [&](const std::string& why) {
    throw Error(ExitStatus::missing_input, fmt::format("cannot read{}{}: {}", limits.what.empty() ? "" : " ", limits.what, why), {path});
  };
  std::string refusal;
  const FileDescriptor file = open_to_read(path, refusal);
  if (!refusal.empty()) fail(refusal);
  constexpr size_t k_block = size_t(1) << 18;
  const std::unique_ptr<char[]> block(new char[k_block]);
  std::string bytes;
  while (bytes.size() < limits.most) {
    const long n = read_some(file.number(), block.get(), std::min(k_block, limits.most - bytes.size()));
    if (n < 0) fail(std::strerror(errno));
    if (n == 0) break;
    bytes.append(block.get(), static_cast<size_t>(n));
  }
  return bytes;
}

} // namespace kelpie
