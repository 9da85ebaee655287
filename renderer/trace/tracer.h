// The tracer: rays against everything in a frame.
#pragma once

#include "renderer/cells/cell_scene.h"
#include "renderer/cells/mesh_scene.h"
#include "scene/scene.h"

namespace kelpie {

struct Hit {
  float t = 0;
  Vec3 position{0};
  Vec3 normal{0};     ///< unit, out of the shape (for a plane: its upper side); smooth on a mesh. It faces the ray
                      ///< where the surface does
  uint32_t shape = 0; ///< index into FrameScene::shapes
  float epsilon = 0;  ///< offset of secondary rays along the normal, on the side where they start
  /// The ray comes out of the shape here; else it goes in. (What is below a plane is inside it.)
  bool is_leaving = false;
  /// From the position to where rays on the near side start, but for the offset: the facets of a smooth mesh lie
  /// below the surface that they stand for, and would shadow one another.
  Vec3 lift{0};
};

/// The sides of a surface, as the ray has it that met it: where it came from, and where it would go.
enum class Side { near, far };

/// A ray that starts at a hit: reflected or towards a light (near), or into what is behind the surface (far).
/// It lies in the shapes that `arrived` lay in, but for the surface that it crosses.
Ray depart(const Ray& arrived, const Hit&, const Vec3& direction, Side);

/// What a frame was built of, for the next one: whatever has not changed is not built again.
struct KeptScenes {
  std::shared_ptr<const CellScene> cells;
  CellLimits limits; ///< of `cells`
  std::shared_ptr<const MeshScene> meshes;
};

/// The surfaces of a frame, ready for rays. Building runs in the current TBB arena.
class Tracer {
public:
  /// `kept` may hold what the last frame was built of, and then holds what this one is. What is kept is the same, to the
  /// last bit, as what would be built. Throws MemoryBudget::Exceeded where the limits have a budget.
  explicit Tracer(const FrameScene& frame, const CellLimits& limits = {}, KeptScenes* kept = nullptr);

  bool intersect(const Ray&, SolveCounters&, Hit&) const;
  bool occluded(const Ray&, SolveCounters&) const;

  /// The same for a packet of up to k_packet rays (see CellScene): returns the rays (bits) that hit.
  uint32_t intersect(std::span<const Ray>, SolveCounters&, Hit*) const;
  uint32_t occluded(std::span<const Ray>, SolveCounters&) const;

  /// The implicit shapes around a point, for Ray::inside.
  ShapeSet shapes_around(const Vec3& p) const;

  /// The box around all implicit shapes; empty if there are none.
  const Box3& bounds() const { return bounds_; }
  size_t cell_count() const;
  size_t element_count() const;
  size_t bytes() const { return cells_->bytes() + meshes_->bytes(); }
  /// Cells that the last frame had left.
  size_t kept_cell_count() const { return kept_cells_; }

private:
  /// An infinite plane and the shape that it is.
  struct PlaneShape {
    Vec3 position, normal;
    uint32_t shape;
  };

  bool meet_geometry(const Ray&, Hit&) const;
  bool meet_planes(const Ray&, Hit&) const;
  void complete(const Ray&, const CellHit&, Hit&) const;

  std::shared_ptr<const CellScene> cells_; ///< one entry a shape of the frame
  std::vector<PlaneShape> planes_;
  std::shared_ptr<const MeshScene> meshes_;
  size_t kept_cells_ = 0;
  Box3 bounds_;
};

} // namespace kelpie
