// What OpenImageIO does for kelpie, behind an interface of our own.
//
// OpenImageIO brings 250 shared libraries, and loading them takes a fifth of a second of every command. So it is in a module,
// kelpie_images.so, that is loaded when something is first asked of it: most commands never do, and frames (EXR) are written and read
// without it.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace kelpie {

/// Three floats a pixel, row by row from the top.
struct PixelRows {
  int width = 0, height = 0;
  float* rgb = nullptr;
};

class ImageLibrary {
public:
  /// Why something failed; nothing where it did not. An empty text: there was no memory for a reason.
  using Failure = std::optional<std::string>;
  /// Called with width, height and channels of a picture: where its pixels go. May throw.
  using MakeRoom = std::function<float*(int, int, int)>;

  virtual ~ImageLibrary() = default;

  /// By a filter without negative lobes.
  virtual Failure resize(const PixelRows& from, const PixelRows& to) const = 0;
  /// Values of 8 or 16 bits, three a pixel, as a PNG file; `is_srgb`: tagged as such.
  virtual Failure encode_png(int width, int height, int bits, const void* values, bool is_srgb, std::vector<unsigned char>& file) const = 0;
  /// A line of text in one grey, centred about `x`, standing on the line `y`.
  virtual void write_text(const PixelRows&, const std::string& text, const std::string& font, int x, int y, int size, float grey) const = 0;
  /// A Radiance HDR picture. Room is made once its header has been read.
  virtual Failure read_radiance(std::span<const unsigned char> file, const MakeRoom&) const = 0;
};

/// The library, loaded at the first call. By any thread. Throws Error internal where the module is missing or broken.
const ImageLibrary& image_library();

} // namespace kelpie

/// What the module exports; null for a program of another version.
extern "C" const kelpie::ImageLibrary* kelpie_image_library(const char* version);
