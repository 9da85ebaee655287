#include "scene/other_names.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "base/suggest.h"

namespace kelpie {

namespace {
constexpr std::array k_other_names = std::to_array<OtherName>({
    {"ball", "sdf_sphere", "point"},
    {"blob", "point"},
    {"blobby", "point"},
    {"capsule", "cone_sphere", "sdf_capsule"},
    {"cube", "box", "sdf_box"},
    {"curve", "generalized_cylinder", "keys"},
    {"cycle", "keys"},
    {"diffuse", "matte"},
    {"directional", "sun"},
    {"distant", "sun"},
    {"formula", "expression"},
    {"hdri", "environment"},
    {"implicit", "point"},
    {"kernel", "falloff"},
    {"lambert", "matte"},
    {"lambertian", "matte"},
    {"lathe", "revolution"},
    {"line", "segment"},
    {"loop", "keys"},
    {"mball", "point"},
    {"metaball", "point"},
    {"metaballs", "blobs", "point"},
    {"metaelement", "point"},
    {"mirror", "scale", "metal"},
    {"morph", "liquid", "animorphosis"},
    {"move", "translate"},
    {"particles", "blobs"},
    {"ring", "torus", "circle"},
    {"smooth_union", "blend"},
    {"softobject", "point"},
    {"sphere", "sdf_sphere", "point"},
    {"subtract", "difference"},
    {"subtraction", "difference"},
    {"sum", "blend"},
    {"sweep", "generalized_cylinder"},
    {"tube", "generalized_cylinder", "segment"},
    {"variable", "expression"},
    {"variables", "expression"},
});
} // namespace

std::span<const OtherName> other_names() { return k_other_names; }

std::string near_names(std::string_view typed, std::span<const std::string_view> known) {
  const auto is_known = [&](std::string_view name) { return std::find(known.begin(), known.end(), name) != known.end(); };
  for (const OtherName& other : k_other_names) {
    if (other.word != typed) continue;
    const bool has_first = is_known(other.name), has_second = is_known(other.other_name);
    if (has_first && has_second) return fmt::format(" (did you mean \"{}\" or \"{}\"?)", other.name, other.other_name);
    if (has_first || has_second) return fmt::format(" (did you mean \"{}\"?)", has_first ? other.name : other.other_name);
  }
  const std::string_view near = nearest_name(typed, known);
  return near.empty() ? "" : fmt::format(" (did you mean \"{}\"?)", near);
}

} // namespace kelpie
