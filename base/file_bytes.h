// Whole input files in memory: every reader of the project parses memory.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace kelpie {

/// The bytes of a file (or a pipe). Throws Error missing_input, "PATH: cannot read: reason".
std::string read_file_bytes(const std::string& path);

/// Text as the bytes that decoders and writers take.
inline std::span<const unsigned char> as_bytes(std::string_view text) {
  return {reinterpret_cast<const unsigned char*>(text.data()), text.size()};
}

} // namespace kelpie
