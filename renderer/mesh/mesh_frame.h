// The shapes of a frame as objects to be written and printed.
#pragma once

#include <functional>
#include <optional>
#include <span>

#include "renderer/mesh/mesh_object.h"
#include "renderer/mesh/self_intersections.h"
#include "scene/scene.h"

namespace kelpie {

/// What is up in a file.
enum class UpAxis { y, z };

struct MeshFrameOptions {
  double units = 1;                                           ///< metres per scene unit
  std::optional<double> size;                                 ///< of the longest side of all objects together, mm, whatever the units
  std::optional<double> tolerance;                            ///< mm; none: a thousandth of the longest side
  size_t most_triangles = std::numeric_limits<size_t>::max(); ///< of all objects together
  /// z: turned so that the scene's y is up, moved so that the box of all begins at the origin, as printers want it. y: places are the
  /// scene's.
  UpAxis up = UpAxis::y;
  std::optional<double> shell;                               ///< hollow, with walls of this thickness, mm
  double drain = 4;                                          ///< of the holes that drain cavities, their diameter, mm; 0: none
  std::function<void(double done)> progress = [](double) {}; ///< 0 to 1
};

struct MeshedFrame {
  std::vector<MeshObject> objects;
  ExactLattice lattice{Box3d{}};               ///< on which all vertices lie
  double tolerance = 0;                        ///< mm
  std::vector<std::string> too_thin_to_hollow; ///< names of objects
};

/// The surfaces of some shapes of a frame, which have fields, in millimetres. A shape that is empty has no triangles. Throws Error,
/// bad_data, for a shape without an end; out_of_memory. Runs in the current TBB arena; does not depend on the number of threads.
MeshedFrame mesh_frame(const FrameScene&, std::span<const size_t> shapes, const MeshFrameOptions&);

} // namespace kelpie
