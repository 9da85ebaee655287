#include "renderer/output/label.h"

#include <array>
#include <filesystem>

#include "renderer/images/image_library.h"

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
  image_library().write_text({picture.width, picture.height, picture.rgb.data()}, text, font(), x, y, size, grey);
}

} // namespace kelpie
