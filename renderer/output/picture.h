// From a frame's channels to pictures that people look at: select, resize, develop, encode.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "colour/view.h"
#include "renderer/output/exr.h"

namespace kelpie {

/// Three floats a pixel over the whole display window, row by row from the top.
struct Picture {
  int width = 0, height = 0;
  std::vector<float> rgb;
  /// Scene-linear light, which a view turns into a picture; else a diagram of data, shown as it is.
  bool is_light = true;

  size_t pixel_count() const { return size_t(width) * size_t(height); }
};

/// The channel or group of channels `name` as a picture. Outside the data window it is black.
///
///   ""            R, G, B: premultiplied, so this is the picture over black. (Over anything else, a
///                 background that the renderer shows with A = 0 would be added to it.)
///   albedo, …     any other group NAME.R NAME.G NAME.B
///   N             world normals, (n + 1) / 2
///   Z             inverse distance, from white (nearest) to dark grey (farthest thing hit); misses are black
///   P             each coordinate as a fraction of the extent of the middle 90 % of what was hit
///   cost          evaluations a sample, on a scale that is the same for all pictures, logarithmic between black: at most 1,
///                 blue: 10, green: 100, yellow: 1,000, red: 10,000, white: 100,000 and more
///   A, or any     one channel as grey, A as it is, others from their least to their greatest value
///
/// Light is converted to scene-linear: from the primaries in the header, linear Rec.709 where there are none
/// (EXR's rule) and the file is not kelpie's own. Throws Error usage, listing the channels there are.
Picture picture_of(const DecodedFrame&, const std::string& name = {});

/// The same of a frame that was just rendered: its light is scene-linear and stays as it is.
Picture picture_of(const FrameImage&, const std::string& name = {});

/// Resampled to `width`, its proportions kept, by a filter without negative lobes (a highlight of 50 times
/// white would ring). Light is averaged as light: resize before developing.
Picture resize(const Picture&, int width);

/// Copies a picture into another, its upper left corner to a pixel of that; of what would lie below the last row nothing.
void paste(Picture& into, const Picture&, int left, int top);

/// To display-referred values in [0, 1]: light is scaled by 2^exposure and seen through the view.
void develop(Picture&, const DisplayView&, float exposure);

/// Rounded to the nearest of 256 values, without dither: three bytes a pixel.
std::vector<uint8_t> to_8_bit(const Picture&);

/// Dithered in order, so that soft gradients have no steps: a value between two of the 256 is either of them, each as often as it is near.
std::vector<uint8_t> dithered_to_8_bit(const Picture&);

/// A display-referred picture as a PNG file of 8 or 16 bits a channel; `is_srgb`: tagged as such. 8 bits are dithered.
std::vector<unsigned char> encode_png(const Picture&, int bits, bool is_srgb);

/// A file's bytes as a page may hold them.
std::string base64(const std::vector<unsigned char>& bytes);

} // namespace kelpie
