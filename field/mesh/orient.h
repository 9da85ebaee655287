// Which side of a mesh is outside.
#pragma once

#include "field/mesh/mesh.h"

namespace kelpie {

/// Triangles connected over edges that exactly two of them share.
struct Components {
  std::vector<uint32_t> of_triangle; ///< the component of each triangle
  uint32_t count = 0;
  size_t turned = 0;         ///< triangles that were turned to agree with their component
  size_t contradictions = 0; ///< edges whose triangles cannot agree (a one-sided surface)
};

/// Finds the components and turns triangles so that neighbours agree; the majority keeps its orientation.
Components orient_consistently(std::vector<Triangle>&);

/// Turns what faces the wrong way. Which component is a cavity in another, and which a body of its own, is as the triangles say: components
/// turn together with the outermost closed one that they lie in, if its volume is negative. An open component has no volume that
/// tells; those that lie in no other turn all together, and only if their joint volume is negative whatever point of their box it is
/// measured from. Returns how many triangles were turned.
size_t orient_outward(const std::vector<Vec3d>& positions, const Components&, std::vector<Triangle>&);

} // namespace kelpie
