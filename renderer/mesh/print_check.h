// Whether objects can be printed.
#pragma once

#include <span>
#include <string>

#include "renderer/mesh/mesh_object.h"
#include "renderer/mesh/self_intersections.h"
#include "renderer/mesh/survey.h"

namespace kelpie {

/// What a printer can do, mm.
struct PrintLimits {
  double wall = 0.8;           ///< the thinnest: two lines of a nozzle of 0.4 mm
  size_t pieces = 1;           ///< of each object
  Vec3d volume{250, 210, 210}; ///< the last is up
};

/// Why not, and where, a line each; empty: they can. Each object must be closed, oriented, a manifold, not in too many pieces and nowhere
/// too thin; none may meet itself or another; together they must fit the volume, which may be turned about what is up (`up_axis`).
std::vector<std::string> print_problems(std::span<const MeshObject>, std::span<const Survey>, const ExactLattice&, int up_axis,
                                        const PrintLimits&);

} // namespace kelpie
