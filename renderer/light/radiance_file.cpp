#include "renderer/light/radiance_file.h"

#include <cmath>
#include <cstdio>
#include <stdexcept>

namespace kelpie {

namespace {
[[noreturn]] void fail(const std::string& why) { throw std::runtime_error(why); }
} // namespace

std::string RadianceReader::line() {
  const size_t end = bytes_.find('\n', at_);
  if (end == std::string::npos) fail("its header has no end");
  const std::string text = bytes_.substr(at_, end - at_);
  at_ = end + 1;
  return text;
}

unsigned char RadianceReader::byte() {
  if (at_ >= bytes_.size()) fail("truncated");
  return static_cast<unsigned char>(bytes_[at_++]);
}

RadianceReader::RadianceReader(const std::string& bytes) : bytes_(bytes) {
  for (std::string text = line(); !text.empty() && text != "\r"; text = line())
    if (text.rfind("FORMAT=", 0) == 0 && text.find("32-bit_rle_rgbe") == std::string::npos) fail("its format is not 32-bit_rle_rgbe");
  const std::string size = line();
  int used = 0;
  if (std::sscanf(size.c_str(), "-Y %9d +X %9d%n", &height_, &width_, &used) != 2 || used == 0)
    fail("its size is not of the form \"-Y height +X width\"");
}

/// Of a row each of the four components by itself, in runs; or, where it does not begin so, four bytes for each pixel.
void RadianceReader::read_row(std::vector<unsigned char>& rgbe) {
  const size_t width = static_cast<size_t>(width_), begin = at_;
  const int first = byte(), second = byte(), high = byte(), low = byte();
  if (first != 2 || second != 2 || size_t(high * 256 + low) != width || width < 8 || width > 0x7fff) {
    at_ = begin;
    for (unsigned char& b : rgbe) b = byte();
    return;
  }
  for (size_t component = 0; component < 4; ++component)
    for (size_t x = 0; x < width;) {
      const size_t code = byte(), count = code > 128 ? code - 128 : code;
      if (count == 0 || count > width - x) fail("a run is longer than its row");
      const unsigned char repeated = code > 128 ? byte() : static_cast<unsigned char>(0);
      for (const size_t end = x + count; x < end; ++x) rgbe[4 * x + component] = code > 128 ? repeated : byte();
    }
}

RadiancePicture RadianceReader::read() {
  const size_t width = static_cast<size_t>(width_), height = static_cast<size_t>(height_);
  RadiancePicture picture{width_, height_, {}};
  picture.rgb.reserve(width * height * 3);
  std::vector<unsigned char> rgbe(width * 4);
  for (size_t y = 0; y < height; ++y) {
    read_row(rgbe);
    for (size_t x = 0; x < width; ++x) {
      const unsigned char* p = &rgbe[4 * x];
      const float unit = p[3] == 0 ? 0.f : std::ldexp(1.f, int(p[3]) - (128 + 8));
      for (int c = 0; c < 3; ++c) picture.rgb.push_back(float(p[c]) * unit);
    }
  }
  return picture;
}

} // namespace kelpie
