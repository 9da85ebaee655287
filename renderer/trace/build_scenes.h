// The Embree scenes of a frame. What has not changed since the last frame is not built again.
#pragma once

#include "renderer/trace/cell_scene.h"
#include "renderer/trace/mesh_scene.h"
#include "scene/scene.h"

namespace kelpie {

/// What a frame was built of, for the next one: whatever has not changed is not built again.
struct KeptScenes {
  std::shared_ptr<const CellScene> cells;
  CellLimits limits; ///< of `cells`
  std::shared_ptr<const MeshScene> meshes;
  bool is_exposed = false; ///< `cells` were built for an open shutter
};

/// The cells of all shapes; of those that are no fields there are none. What is kept is the same, to the last bit, as what would be
/// built. `kept` then holds what the frame was built of; `kept_cells` counts those that the last frame had left. Throws
/// BuildBudget::OutOfMemory where the limits have a budget.
std::shared_ptr<const CellScene> build_cell_scene(const FrameScene&, const CellLimits&, KeptScenes& kept, size_t& kept_cells);

/// The same for meshes.
std::shared_ptr<const MeshScene> build_mesh_scene(const FrameScene&, const CellLimits&, KeptScenes& kept);

} // namespace kelpie
