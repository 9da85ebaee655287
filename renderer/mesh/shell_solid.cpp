#include "renderer/mesh/shell_solid.h"

#include <algorithm>
#include <limits>

namespace kelpie {

namespace {

double distance_to(const DrainHole& hole, const Vec3d& p) {
  const Vec3d way = hole.to - hole.from;
  const double along = std::clamp(glm::dot(p - hole.from, way) / glm::dot(way, way), 0.0, 1.0);
  return glm::distance(p, hole.from + along * way) - hole.radius;
}

} // namespace

double ShellSolid::value(const Code& code, const Vec3d& p) const {
  const double distance = surface_.distance(p, std::numeric_limits<double>::infinity());
  if (solid_.value(code, p) <= 0) return -distance;
  double value = std::min(distance, wall_ - distance);
  for (const DrainHole& hole : holes_) value = std::min(value, distance_to(hole, p));
  return value;
}

Solid::InBox ShellSolid::in_box(const Box3d& box, const Code& parent) const {
  InBox out = solid_.in_box(box, parent);
  if (out.content == Content::empty) return out;
  const double at_centre = value(out.code, box.centre()), reach = 0.5 * glm::length(box.extent());
  out.content = at_centre > reach ? Content::full : at_centre < -reach ? Content::empty : Content::unknown;
  return out;
}

Vec3d ShellSolid::gradient(const Code& code, const Vec3d& p) const {
  const double step = 1e-4 * wall_;
  Vec3d out;
  for (int axis = 0; axis < 3; ++axis) {
    Vec3d h(0);
    h[axis] = step;
    out[axis] = (value(code, p + h) - value(code, p - h)) / (2 * step);
  }
  return out;
}

/// Two sheets are a wall apart: what is smaller holds one of them, and whatever is small in a cavity may be lost.
bool ShellSolid::is_one_sheet(const Code&, const Box3d& box) const { return glm::length(box.extent()) < wall_; }

} // namespace kelpie
