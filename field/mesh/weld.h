// Vertices that are meant to be one.
#pragma once

#include <vector>

#include "field/mesh/mesh.h"

namespace kelpie {

/// For each position the index of the first that is equal.
std::vector<uint32_t> first_at_same_place(const std::vector<Vec3d>& positions);

/// What `weld_borders` did.
struct Weld {
  size_t vertices = 0; ///< that became another
  double farthest = 0; ///< how far one of them was moved
};

/// Makes one of vertices that are nearer to each other than `tolerance` and lie on open borders (edges of one triangle): seams between
/// parts of a mesh whose copies of a vertex differ by rounding. The first of them stays where it is; vertices that no border has are left
/// alone. Tolerance 0: a 10,000th of the diagonal, but no more than a quarter of the shortest edge at either vertex, so that no edge
/// vanishes. Triangles are renumbered, and may then name a vertex twice.
Weld weld_borders(const std::vector<Vec3d>& positions, std::vector<Triangle>&, double tolerance);

/// The same, with a warning where anything was done.
void weld_borders(const std::vector<Vec3d>& positions, std::vector<Triangle>&, double tolerance, const std::string& file, Diagnostics&);

} // namespace kelpie
