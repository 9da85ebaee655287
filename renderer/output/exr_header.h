// What an EXR file says about its frame, as attributes of its header.
#pragma once

#include <OpenEXR/ImfHeader.h>

#include "renderer/output/exr.h"

namespace kelpie {

/// Adds all but windows, channels and compression. Dates are fixed: equal frames are equal bytes.
void write_header(Imf::Header&, const FrameHeader&, const std::string& pixel_hash);

/// Fills all but the pixels, their channels and their hash. What is missing, or of another type, stays as it is.
void read_header(const Imf::Header&, DecodedFrame&);

} // namespace kelpie
