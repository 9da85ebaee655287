// What is known but not built yet: refused by name, never ignored. A line goes when its feature comes.
#pragma once

#include <array>
#include <string_view>

namespace kelpie {

enum class ReservedAs {
  kind,  ///< `owner` is the group, such as "surface"
  key,   ///< `owner` is what has the key, such as "shape"
  value, ///< `owner` is the parameter
};

struct Reserved {
  ReservedAs as;
  std::string_view owner, name;
};

inline constexpr std::array k_reserved{
    Reserved{ReservedAs::key, "openpbr", "transmission_scatter"},
    Reserved{ReservedAs::key, "openpbr", "transmission_scatter_anisotropy"},
    Reserved{ReservedAs::key, "openpbr", "coat_roughness_anisotropy"},
    Reserved{ReservedAs::key, "openpbr", "fuzz_weight"},
    Reserved{ReservedAs::key, "openpbr", "fuzz_color"},
    Reserved{ReservedAs::key, "openpbr", "fuzz_roughness"},
    Reserved{ReservedAs::key, "openpbr", "geometry_opacity"},
    Reserved{ReservedAs::key, "openpbr", "geometry_thin_walled"},
    Reserved{ReservedAs::key, "openpbr", "geometry_coat_normal"},
    Reserved{ReservedAs::key, "openpbr", "geometry_coat_tangent"},
    Reserved{ReservedAs::key, "openpbr", "geometry_normal"},
    Reserved{ReservedAs::value, "aovs", "cryptomatte"},
    Reserved{ReservedAs::value, "correspondence", "hierarchical"},
};

constexpr bool is_reserved(ReservedAs as, std::string_view owner, std::string_view name) {
  for (const Reserved& r : k_reserved)
    if (r.as == as && r.owner == owner && r.name == name) return true;
  return false;
}

} // namespace kelpie
