// Whole files: read at once, written all or nothing.
#pragma once

#include <string>
#include <string_view>

namespace kelpie {

/// The bytes of the file. Throws Error, missing_input, where it does not exist or cannot be read.
std::string read_file_bytes(const std::string& path);

/// Writes `bytes` to a `.part` file beside `path`, syncs it and renames it: `path` holds the old bytes
/// or all of the new ones, whatever happens. Throws Error, cannot_write; leaves no `.part` file behind.
void write_file_bytes(const std::string& path, std::string_view bytes);

} // namespace kelpie
