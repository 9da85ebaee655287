// Text within HTML and SVG.
#pragma once

#include <string>
#include <string_view>

namespace kelpie {

/// The text where markup would be understood.
inline std::string escaped(std::string_view text) {
  std::string out;
  for (const char c : text) switch (c) {
    case '&': out += "&amp;"; break;
    case '<': out += "&lt;"; break;
    case '>': out += "&gt;"; break;
    case '"': out += "&quot;"; break;
    default: out += c;
    }
  return out;
}

} // namespace kelpie
