// Materials: a surface, or a pattern that ranges over materials.
#pragma once

#include <vector>

#include "base/error.h"
#include "materials/patterns.h"
#include "materials/surfaces.h"
#include "materials/transition.h"

namespace kelpie {

/// Those that are something by default.
using PlainMaterialKinds = Concat<SurfaceKinds, PatternKinds>;
using MaterialKinds = Concat<PlainMaterialKinds, KindList<Transition>>;

/// A node of a tree of materials; its parameters may be animated.
struct MaterialNode {
  MaterialKinds::Variant<AnimatedMode> kind;
  SourcePosition where;
  int depth = 1; ///< how many materials stand in one another, this one included
  int count = 1; ///< how many there are in the tree, as often as it refers to them
};

using MaterialPtr = AnimatedMode::Material;

/// A material of this kind, as it is by default.
template <template <class> class Kind>
MaterialPtr make_material(Kind<AnimatedMode> kind = {}) {
  return std::make_shared<MaterialNode>(MaterialNode{std::move(kind), {}});
}

/// Its base colour at a frame, scene-linear; where it ranges over others, the mean of theirs.
Vec3 mean_colour(const MaterialNode&, double frame);

/// The materials of a scene at one moment; those that a pattern ranges over stand before it.
using SampledMaterials = std::vector<MaterialKinds::Variant<SampledMode>>;

/// Adds a material, seen at a point of its space, to a mix (SurfaceMix or HeightMix), with a weight.
template <class Mix>
void add_material(const SampledMaterials&, MaterialIndex, const Vec3& p, const Footprint&, float weight, Mix&);

/// Whether it is the same everywhere: a surface. That is then `surface_of`.
bool is_uniform(const SampledMaterials&, MaterialIndex);
SurfaceParameters surface_of(const SampledMaterials&, MaterialIndex);

/// Whether some surface that it ranges over has a `bump_height`.
bool has_height(const SampledMaterials&, MaterialIndex);

} // namespace kelpie
