// What is known of a shape around points of its surface.
#pragma once

#include "field/mesh/triangle_tree.h"
#include "morph/liquid/surface_samples.h"

namespace kelpie {

/// A point of a mesh's surface, in units of its diagonal, and how much room is around it.
struct FitSample : SurfaceSample {
  double inner = 0; ///< the radius of the largest ball that touches it from below and that the surface does not reach into, about
  double outer = 0; ///< and from above, up to k_most_outer
};

inline constexpr double k_most_outer = 0.04;

/// Whether the mesh's normal says anything there: along creases it is a mean of both sides.
inline bool has_normal(const SurfaceSample& s) { return glm::dot(s.normal, s.smooth) > 0.9; }

/// About `count` samples, spread evenly in no spatial order; those with nothing below them are left out.
std::vector<FitSample> fit_samples(const Mesh& unit, const TriangleTree&, size_t count, uint64_t seed);

} // namespace kelpie
