// Subdivision surfaces: a mesh of polygons as the cage of a smooth surface.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "base/box.h"
#include "base/error.h"

namespace kelpie {

/// A subdivision surface at levels of refinement. Every vertex lies on the limit surface.
struct SubdivisionMesh {
  struct Level {
    std::vector<Vec3> positions, normals; ///< of length 1, or 0 where there is none
    std::vector<float> thickness;
    std::vector<std::array<uint32_t, 4>> faces;
    std::vector<std::array<uint32_t, 2>> borders; ///< edges of a single face, and creases of none
    double error = 0;                             ///< how far its faces are from the surface, measured at the next level's vertices
  };
  std::vector<Level> levels; ///< ever finer; the first is refined once
  Box3d box;                 ///< of the surface
};

/// Refined further a surface is refused.
constexpr size_t k_most_subdivided_faces = 4'000'000;

/// Reads OBJ, PLY, OFF or STL and refines it up to `levels` times by the rule of Catmull and Clark, with OpenSubdiv; border edges and
/// corners stay where they are. Vertices of a PLY may have a property `thickness` (1 where there is none), which is smoothed as the
/// positions are. Throws Error: missing_input, or bad_data.
SubdivisionMesh load_subdivision_mesh(const std::string& path, int levels, Diagnostics&);

} // namespace kelpie
