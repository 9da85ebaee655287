// PNG files, by libpng, in memory.
#pragma once

#include <vector>

namespace kelpie {

/// RGB rows from the top, without gaps: a byte a channel, or two of the machine's order. `is_srgb`: tagged as such. The same
/// pixels make the same bytes. Throws Error internal when libpng fails, bad_alloc for lack of memory.
std::vector<unsigned char> png_file(int width, int height, int bits, bool is_srgb, const void* pixels);

} // namespace kelpie
