#include "renderer/output/label.h"

#include <array>
#include <filesystem>

#include <OpenImageIO/imagebuf.h>
#include <OpenImageIO/imagebufalgo.h>

namespace kelpie {

namespace {

std::string find_font() {
  constexpr std::array k_fonts{"/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf",
                               "/usr/share/fonts/truetype/liberation/LiberationSans-Regular.ttf",
                               "/usr/share/fonts/truetype/noto/NotoSans-Regular.ttf"};
  for (const char* font : k_fonts)
    if (std::error_code error; std::filesystem::exists(font, error)) return font;
  return {};
}

const std::string& font() {
  static const std::string found = find_font();
  return found;
}

} // namespace

bool has_font() { return !font().empty(); }

void write_label(Picture& picture, const std::string& text, int x, int y, int size, float grey) {
  if (!has_font()) return;
  OIIO::ImageBuf pixels(OIIO::ImageSpec(picture.width, picture.height, 3, OIIO::TypeDesc::FLOAT), picture.rgb.data());
  OIIO::ImageBufAlgo::render_text(pixels, x, y, text, size, font(), {grey, grey, grey}, OIIO::ImageBufAlgo::TextAlignX::Center);
}

} // namespace kelpie
