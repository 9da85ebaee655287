// The tracer: rays against everything in a frame.
#pragma once

#include <optional>

#include "field/motion.h"
#include "renderer/trace/cell_scene.h"
#include "renderer/trace/media.h"
#include "renderer/trace/mesh_scene.h"
#include "scene/scene.h"

namespace kelpie {

struct Hit {
  float t = 0;
  Vec3 position{0};
  Vec3 normal{0};                   ///< unit, out of the shape (for a plane: its upper side); smooth on a mesh. It faces the ray
                                    ///< where the surface does
  uint32_t shape = 0;               ///< index into FrameScene::shapes
  uint32_t cell = 0;                ///< of `slab`
  const ShapeCells* slab = nullptr; ///< the shape's cells at the ray's time; null where it is geometry
  float time = 0;                   ///< the ray's
  float epsilon = 0;                ///< offset of secondary rays along the normal, on the side where they start
  /// The ray comes out of the shape here; else it goes in. (What is below a plane is inside it.)
  bool is_leaving = false;
  /// From the position to where rays on the near side start, but for the offset: the facets of a smooth mesh lie
  /// below the surface that they stand for, and would shadow one another.
  Vec3 lift{0};
};

/// The normal, turned to the side from which the ray came. What is near and far of a surface is decided by it alone.
Vec3 facing_normal(const Ray& arrived, const Hit&);

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
  bool is_exposed = false; ///< `cells` were built for an open shutter
};

/// The states of something that costs nothing to keep, at this many equal steps of the exposure.
inline constexpr int k_states = 65;

/// Between states at equal steps of the exposure; of something that stands there is one.
template <class Kind>
Kind state_at(const std::vector<Kind>& states, float time) {
  if (states.size() == 1) return states[0];
  const float place = time * static_cast<float>(states.size() - 1);
  const size_t i = std::min(static_cast<size_t>(place), states.size() - 2);
  return interpolated(states[i], states[i + 1], place - static_cast<float>(i));
}

/// The states of what `part(FrameScene)` is of a scene, so many frames later.
template <class Part>
auto states_of(const FrameScene& frame, double later, Part&& part) {
  const Exposure exposure = frame.exposure();
  std::vector states{part(frame)};
  if (exposure.length == 0) return states;
  const auto first = part(frame.moment(exposure.start + later));
  bool moves = false;
  states.clear();
  for (int i = 0; i < k_states; ++i) {
    states.push_back(part(frame.moment(exposure.frame_at(double(i) / (k_states - 1)) + later)));
    moves = moves || !is_same(states.back(), first);
  }
  if (!moves) states.resize(1);
  return states;
}

/// The surfaces of a frame, ready for rays. Building runs in the current TBB arena.
class Tracer {
public:
  /// `kept` may hold what the last frame was built of, and then holds what this one is. What is kept is the same, to the
  /// last bit, as what would be built. Throws MemoryBudget::Exceeded where the limits have a budget.
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

  /// The most slabs of time that any shape has, each of the same length.
  size_t slab_count() const { return cells_->slab_count(); }
  /// Into so many equal windows time is divided: a packet's rays had better share one.
  size_t window_count() const { return cells_->window_count(); }

  /// The box around all implicit shapes; empty if there are none.
  const Box3& bounds() const { return bounds_; }
  size_t cell_count() const;
  size_t element_count() const;
  size_t bytes() const { return cells_->bytes() + meshes_->bytes(); }
  /// Cells that the last frame had left.
  size_t kept_cell_count() const { return kept_cells_; }

private:
  friend class Surroundings;

  /// An infinite plane and the shape that it is.
  struct PlaneShape {
    std::vector<Plane<SampledMode>> states; ///< see state_at
    uint32_t shape;
  };

  bool meet_geometry(const Ray&, Hit&) const;
  bool meet_planes(const Ray&, Hit&) const;
  void complete(const Ray&, const CellHit&, Hit&) const;

  double exposure_ = 0; ///< in frames
  Media media_;
  std::shared_ptr<const CellScene> cells_; ///< one entry a shape of the frame
  std::vector<PlaneShape> planes_;
  std::shared_ptr<const MeshScene> meshes_;
  size_t kept_cells_ = 0;
  Box3 bounds_;
};

/// What the rays that start in a small box start in.
class Surroundings {
public:
  Surroundings(const Tracer&, const Box3& where);
  /// The implicit shapes around a point of the box, for Ray::inside.
  ShapeSet shapes_around(const Vec3& p, float time) const;

private:
  /// What is left of a shape's program in the box, in a slab of time.
  struct Slab {
    const ShapeCells* cells;
    std::optional<bool> is_inside; ///< if it is the same everywhere, always
    Code code;                     ///< else
  };
  std::vector<std::vector<Slab>> shapes_;
};

} // namespace kelpie
