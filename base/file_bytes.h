// Whole input files in memory: every reader of the project parses memory.
#pragma once

#include <limits>
#include <span>
#include <string>
#include <string_view>

namespace kelpie {

struct ReadLimits {
  std::string what = {};                            ///< for messages: "cannot read WHAT: reason"
  size_t most = std::numeric_limits<size_t>::max(); ///< what is beyond so many bytes is left
};

/// The bytes of a file, or of a pipe that was handed over (/dev/stdin). Throws Error missing_input, "PATH: cannot read: reason".
std::string read_file_bytes(const std::string& path, const ReadLimits& limits = {});

/// Text as the bytes that decoders and writers take.
inline std::span<const unsigned char> as_bytes(std::string_view text) {
  return {reinterpret_cast<const unsigned char*>(text.data()), text.size()};
}

} // namespace kelpie
