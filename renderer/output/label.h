// Words on pictures.
#pragma once

#include <string>

#include "renderer/output/picture.h"

namespace kelpie {

/// Whether there is a font to write with: one of DejaVu's, of Liberation's or of Noto's, where Debian has them.
bool has_font();

/// Writes a line of text into a display-referred picture, in one grey, centred about `x`, standing on the line `y`. `size`: the height of
/// the font, in pixels. Writes nothing where there is no font.
void write_label(Picture&, const std::string& text, int x, int y, int size, float grey);

} // namespace kelpie
