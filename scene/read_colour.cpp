// Colours: scene-linear triples, "#rrggbb", and triples of any OCIO space.
#include <algorithm>
#include <charconv>

#include "colour/spaces.h"
#include "scene/value_reader.h"

namespace kelpie {

namespace {
constexpr std::string_view k_colour_form = R"([r, g, b], "#rrggbb" or {"space": …, "rgb": [r, g, b]})";
/// Conversion between spaces rounds; white must not become 1.0000002 and be refused.
constexpr double k_tolerance = 1e-4;
} // namespace

bool ValueReader::read_hex_colour(Vec3& out, const JsonValue& v, std::string_view name) {
  const std::string& text = *v.string();
  const char* const end = text.data() + text.size();
  unsigned rgb = 0;
  const bool is_hex = text.size() == 7 && text[0] == '#' && std::isxdigit(static_cast<unsigned char>(text[1])) &&
                      std::from_chars(text.data() + 1, end, rgb, 16).ptr == end;
  if (!is_hex) return fail(v, fmt::format("{}: expected {}, found {}", name, k_colour_form, in_quotes(text)));
  try {
    out = to_scene_linear(Vec3(rgb >> 16, rgb >> 8 & 255, rgb & 255) / 255.f, "color_picking");
  } catch (const Error& e) {
    problems_.add(e, where(v));
    return false;
  }
  return true;
}

bool ValueReader::read_colour_in_space(Vec3& out, const JsonValue& v, std::string_view name) {
  constexpr std::array<std::string_view, 2> k_keys{"space", "rgb"};
  bool is_good = check_only(v, k_keys);
  const JsonValue *space = v.find("space"), *rgb = v.find("rgb");
  if (!space || !rgb) return fail(v, fmt::format("{}: missing key \"{}\" of the colour", name, space ? "rgb" : "space"));
  if (!space->string()) is_good = fail_type(*space, "space", "the name of a colour space");
  Vec3 triple;
  if (!read_triple(triple, *rgb, "rgb", "[r, g, b]") || !is_good) return false;
  try {
    out = to_scene_linear(triple, *space->string());
  } catch (const Error& e) {
    problems_.add(e, where(*space));
    return false;
  }
  return true;
}

bool ValueReader::read(Colour& out, const JsonValue& v, const ParameterRules& rules) {
  const bool is_converted = v.string() || v.object();
  const bool is_good = v.string()   ? read_hex_colour(out.rgb, v, rules.name)
                       : v.object() ? read_colour_in_space(out.rgb, v, rules.name)
                                    : read_triple(out.rgb, v, rules.name, k_colour_form);
  if (!is_good) return false;
  for (size_t i = 0; i < 3; ++i) {
    float& c = out.rgb[i];
    const Range& range = rules.range;
    if (is_converted && c < range.lower && c >= range.lower - k_tolerance) c = static_cast<float>(range.lower);
    if (is_converted && c > range.upper && c <= range.upper + k_tolerance) c = static_cast<float>(range.upper);
    if (range.contains(double(c))) continue;
    const JsonValue& at = v.array() ? (*v.array())[i] : v;
    return fail(at, fmt::format("{} must be {}, found {}{}", rules.name, describe(range), c, is_converted ? " in scene_linear" : ""));
  }
  return true;
}

bool ValueReader::read(Background& out, const JsonValue& v, const ParameterRules& rules) {
  if (v.string() && *v.string() == "environment")
    out.kind = Background::Kind::environment;
  else if (v.string() && *v.string() == "transparent")
    out.kind = Background::Kind::transparent;
  else if (v.string() && v.string()->substr(0, 1) != "#")
    return fail(v, fmt::format("{}: expected \"environment\", \"transparent\" or a colour, found {}", rules.name, in_quotes(*v.string())));
  else
    out.kind = Background::Kind::colour;
  return out.kind != Background::Kind::colour || read(out.colour, v, rules);
}

} // namespace kelpie
