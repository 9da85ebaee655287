// A compressor of one purpose: bytes of frames as EXR reorders them, into zlib's format.
#pragma once

#include <span>
#include <vector>

namespace kelpie {

/// Replaces `zipped`. Only runs of one byte are sought, and codes are made for what is left (Huffman's, new ones for every 32,768 symbols):
/// zlib with its strategy Z_RLE makes about the same, in two and a half times the time. What cannot be made smaller is stored.
void deflate_runs(std::span<const unsigned char> bytes, std::vector<unsigned char>& zipped);

} // namespace kelpie
