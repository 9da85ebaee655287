// The benchmarks' tree: a water dragon of about 2,000 cone-spheres in sums, unions and R-unions.
#pragma once

#include <string>
#include <string_view>

namespace kelpie {

/// What of the creature lies below warps that are not affine.
enum class CreatureWarps {
  none,
  twist, ///< all of it below one twist, its mane below a second
  bend,  ///< all of it below a bend, its mane below a twist
};
/// How benchmarks call it: `creature`, `creature_twisted`, `creature_bent`.
std::string_view creature_name(CreatureWarps warps);

/// The scene file of the creature, with a camera and a sun; the same text on every machine. The picture is one
/// sample through each pixel's centre, direct light only: what benchmarks compare.
std::string make_creature_scene(CreatureWarps warps);

} // namespace kelpie
