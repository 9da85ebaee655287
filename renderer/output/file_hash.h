// A hash of all bytes of a frame's file, kept in its header, so that any byte that was altered afterwards is noticed: in the header,
// in the table of offsets, or in the pixels.
#pragma once

#include <span>
#include <string>

namespace kelpie {

/// The attribute of the header that holds it, and what it holds until the file is sealed: as many digits.
inline constexpr const char* k_file_hash_attribute = "kelpie:fileHash";
std::string unsealed_file_hash();

/// Puts XXH3-128 of all bytes, with zeros for these digits, into the header. Throws Error internal where it has no place for it.
void seal(std::span<unsigned char> file);

/// Whether the bytes are those that were sealed.
bool is_sealed(std::span<const unsigned char> file);

} // namespace kelpie
