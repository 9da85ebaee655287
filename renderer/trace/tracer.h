// The tracer: rays against everything in a frame.
#pragma once

#include "renderer/program/leaves_at.h"
#include "renderer/trace/build_scenes.h"
#include "renderer/trace/media.h"
#include "renderer/trace/planes.h"

namespace kelpie {

/// The surfaces of a frame, ready for rays. Building runs in the current TBB arena.
class Tracer {
public:
  /// `kept` may hold what the last frame was built of, and then holds what this one is. What is kept is the same, to the
  /// last bit, as what would be built. Throws BuildBudget::OutOfMemory where the limits have a budget.
  explicit Tracer(const FrameScene& frame, const CellLimits& limits = {}, KeptScenes* kept = nullptr);

  /// The first surface that the ray meets, whether it can be seen there or not.
  bool intersect(const Ray&, SolveCounters&, Hit&) const;
  /// Whether the ray meets a surface that can be seen there.
  bool occluded(const Ray&, SolveCounters&) const;

  /// The same for a packet of up to k_packet rays (see CellScene): returns the rays (bits) that hit.
  uint32_t intersect(std::span<const Ray>, SolveCounters&, Hit*) const;
  uint32_t occluded(std::span<const Ray>, SolveCounters&) const;

  /// Takes a ray that met `hit` to the first surface that can be seen: through all that lie in media of higher priority. The ray
  /// then starts behind the last of these, and `hit` is what it meets; false if there is nothing more.
  bool pass_hidden(Ray&, SolveCounters&, Hit& hit) const;
  const Media& media() const { return media_; }

  /// The velocity of the surface where a ray hit it, along its normal: -F_t grad F / |grad F|^2 with F the field
  /// minus the threshold. Scene units a frame. (Of what slides within the surface a field knows nothing; a mesh does, and has
  /// all of its velocity.)
  Vec3 velocity(const Hit&) const;

  /// The normal of the field that a ray hit, as that of the hit, at a point near it; of what is no field the hit's own.
  Vec3 normal_near(const Hit&, const Vec3& p) const;

  /// The leaves that make the field where a ray hit it, if that is an implicit shape; the limits must ask for identities.
  void leaves_at(const Hit&, std::vector<LeafAt>& out) const;

  /// The most slabs of time that any shape has, each of the same length.
  size_t slab_count() const { return cells_->slab_count(); }
  /// See CellScene.
  size_t window_count() const { return cells_->window_count(); }

  /// The box around all implicit shapes; empty if there are none.
  const Box3& bounds() const { return bounds_; }
  size_t cell_count() const;
  size_t element_count() const;
  size_t bytes() const { return cells_->bytes() + meshes_->bytes(); }
  /// Cells that the last frame had left.
  size_t kept_cell_count() const { return kept_cells_; }

  const CellScene& cells() const { return *cells_; }

private:
  bool meet_geometry(const Ray&, Hit&) const;
  void complete(const Ray&, const CellHit&, Hit&) const;

  double exposure_ = 0; ///< in frames
  Media media_;
  std::shared_ptr<const CellScene> cells_; ///< one entry a shape of the frame
  Planes planes_;
  std::shared_ptr<const MeshScene> meshes_;
  size_t kept_cells_ = 0;
  Box3 bounds_;
};

} // namespace kelpie
