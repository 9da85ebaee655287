// Random rays at a scene.
#pragma once

#include "renderer/trace/tracer.h"
#include "tests/support/random_kind.h"
#include "tests/support/reference_scene.h"

namespace kelpie {

/// A part of a ray; `to` < `from`: none.
struct Stretch {
  double from, to;
};

/// Where the ray is in the box.
inline Stretch inside(const reference::Ray& ray, const Box3& box) {
  Stretch s{0, std::numeric_limits<double>::infinity()};
  const double o[] = {ray.origin.x, ray.origin.y, ray.origin.z}, d[] = {ray.direction.x, ray.direction.y, ray.direction.z};
  for (int i = 0; i < 3; ++i) {
    if (d[i] == 0) {
      if (o[i] < box.lower[i] || o[i] > box.upper[i]) return {1, 0};
      continue;
    }
    const double a = (box.lower[i] - o[i]) / d[i], b = (box.upper[i] - o[i]) / d[i];
    s.from = std::max(s.from, std::min(a, b)), s.to = std::min(s.to, std::max(a, b));
  }
  return s;
}

inline void collect_leaves(const reference::Node& node, std::vector<reference::Leaf>& out) {
  out.insert(out.end(), node.leaves.begin(), node.leaves.end());
  for (const reference::NodePtr& child : node.children) collect_leaves(*child, out);
}

/// Something to aim at: half of the time anywhere in the box, half of the time at or past an element, where
/// surfaces are small, thin or grazed.
inline Vec3 random_target(Random& r, const Box3& box, const std::vector<reference::Leaf>& leaves) {
  if (leaves.empty() || r.below(2)) return Vec3(r.in(Box3d{Vec3d(box.lower), Vec3d(box.upper)}));
  const reference::Leaf& leaf = leaves[r.below(int(leaves.size()))];
  return Vec3(Vec3d(leaf.a.x, leaf.a.y, leaf.a.z) + r.direction() * leaf.radius * square(r.uniform(0, 1)));
}

inline Ray random_ray(Random& r, const Box3& box, const std::vector<reference::Leaf>& leaves, bool starts_far, double most_sizes = 3) {
  Ray ray;
  const double size = box.diagonal();
  const Vec3 target = random_target(r, box, leaves);
  if (r.below(10) == 0) { // along an axis: many cells share their borders with such rays
    ray.direction[r.below(3)] = r.below(2) ? 1.f : -1.f;
    ray.origin = target - ray.direction * float(starts_far ? 2 * size : 0.1 * size);
    return ray;
  }
  ray.origin = starts_far
                   ? box.centre() + Vec3(r.direction() * (most_sizes > 3 ? r.log_uniform(0.6, most_sizes) : r.uniform(0.6, 3)) * size)
                   : random_target(r, box, {});
  ray.direction = glm::normalize(target - ray.origin);
  return ray;
}

/// A ray from where another hit, back into the open or on into the shape, in any direction on that side; at times nearly along the
/// surface, and at times with an end, as a ray to a lamp has one.
inline Ray random_departure(Random& r, const Ray& arrived, const Hit& hit, Side side, float size) {
  const Vec3 back = glm::dot(hit.normal, arrived.direction) > 0 ? -hit.normal : hit.normal, away = side == Side::near ? back : -back;
  Vec3 direction(r.direction());
  float along = glm::dot(direction, away);
  if (along < 0) direction -= 2 * along * away, along = -along;
  if (r.below(4) == 0) direction = glm::normalize(direction - float(r.uniform(0.9, 1)) * along * away);
  Ray ray = depart(arrived, hit, direction, side);
  if (r.below(2)) ray.t_far = size * float(r.log_uniform(1e-3, 1));
  return ray;
}

} // namespace kelpie
