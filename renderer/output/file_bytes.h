// A whole input file in memory: what the picture decoders are given, so that each reads from memory only.
#pragma once

#include <string>
#include <vector>

namespace kelpie {

/// Throws Error missing_input, "PATH: reason".
std::vector<unsigned char> read_file_bytes(const std::string& path);

} // namespace kelpie
