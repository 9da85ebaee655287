// A shape as mesh files have it.
#pragma once

#include <string>

#include "field/mesh/mesh.h"

namespace kelpie {

/// A named closed surface, in millimetres.
struct MeshObject {
  std::string name;
  Mesh mesh;
  std::vector<std::array<uint8_t, 3>> colours; ///< of each vertex, sRGB
};

} // namespace kelpie
