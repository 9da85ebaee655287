#include "renderer/trace/hit.h"

namespace kelpie {

Vec3 facing_normal(const Ray& arrived, const Hit& hit) { return glm::dot(hit.normal, arrived.direction) > 0 ? -hit.normal : hit.normal; }

Ray depart(const Ray& arrived, const Hit& hit, const Vec3& direction, Side side) {
  const Vec3 back = facing_normal(arrived, hit);
  Ray ray;
  ray.origin = side == Side::near ? hit.position + hit.lift + hit.epsilon * back : hit.position - hit.epsilon * back;
  ray.direction = direction;
  ray.inside = arrived.inside, ray.time = arrived.time;
  if (side == Side::near) return ray;
  if (hit.is_leaving)
    ray.inside.remove(hit.shape);
  else
    ray.inside.add(hit.shape);
  return ray;
}

} // namespace kelpie
