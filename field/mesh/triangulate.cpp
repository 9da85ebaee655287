#include "field/mesh/triangulate.h"

#include <cmath>

namespace kelpie {

namespace {

double cross(Vec2d a, Vec2d b, Vec2d c) { return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x); }

Vec3d newell_normal(const std::vector<Vec3d>& positions, const std::vector<uint32_t>& corners) {
  Vec3d n(0);
  const Vec3d& first = positions[corners[0]];
  for (size_t i = 1; i + 1 < corners.size(); ++i) n += glm::cross(positions[corners[i]] - first, positions[corners[i + 1]] - first);
  return n;
}

/// Seen along the axis in which the normal is largest, turned so that the outline runs counter-clockwise.
std::vector<Vec2d> project(const std::vector<Vec3d>& positions, const std::vector<uint32_t>& corners) {
  const Vec3d n = newell_normal(positions, corners), size = glm::abs(n);
  const int k = size.x > size.y && size.x > size.z ? 0 : size.y > size.z ? 1 : 2;
  const int u = (k + 1) % 3, v = (k + 2) % 3;
  std::vector<Vec2d> flat;
  flat.reserve(corners.size());
  for (const uint32_t c : corners)
    flat.push_back(n[k] >= 0 ? Vec2d(positions[c][u], positions[c][v]) : Vec2d(positions[c][v], positions[c][u]));
  return flat;
}

/// Ear clipping on a ring of corners.
class EarClipper {
public:
  EarClipper(std::vector<Vec2d> points, const std::vector<uint32_t>& corners, std::vector<Triangle>& out)
      : p_(std::move(points)), corners_(corners), out_(out), left_(p_.size()), previous_(p_.size()), next_(p_.size()) {
    for (size_t i = 0; i < p_.size(); ++i) previous_[i] = (i + p_.size() - 1) % p_.size(), next_[i] = (i + 1) % p_.size();
    for (size_t i = 0; i < p_.size(); ++i)
      if (is_reflex(i)) reflex_.push_back(i);
    budget_ = 64 * p_.size() + 4'000'000; // outlines that fold over themselves must not take hours
  }

  void clip() {
    size_t i = 0, since_ear = 0;
    while (left_ > 3 && since_ear <= left_ && budget_ > 0) {
      if (is_ear(i)) {
        emit(i);
        i = previous_[i];
        since_ear = 0;
      } else {
        i = next_[i];
        ++since_ear;
      }
    }
    while (left_ >= 3) emit(i = next_[i]); // the last triangle, or a fan of what has no ear
  }

private:
  bool is_reflex(size_t i) const { return cross(p_[previous_[i]], p_[i], p_[next_[i]]) <= 0; }

  /// A convex corner whose triangle holds no reflex corner.
  bool is_ear(size_t i) {
    --budget_;
    if (is_reflex(i)) return false;
    const Vec2d &a = p_[previous_[i]], &b = p_[i], &c = p_[next_[i]];
    size_t kept = 0;
    bool is_free = true;
    for (const size_t r : reflex_) {
      if (removed(r) || !is_reflex(r)) continue; // corners only ever become more convex
      reflex_[kept++] = r;
      if (!is_free || r == previous_[i] || r == next_[i] || p_[r] == a || p_[r] == b || p_[r] == c) continue;
      is_free = !(cross(a, b, p_[r]) >= 0 && cross(b, c, p_[r]) >= 0 && cross(c, a, p_[r]) >= 0);
    }
    budget_ -= static_cast<long long>(reflex_.size());
    reflex_.resize(kept);
    return is_free;
  }

  bool removed(size_t i) const { return next_[previous_[i]] != i; }

  void emit(size_t i) {
    out_.push_back({corners_[previous_[i]], corners_[i], corners_[next_[i]]});
    next_[previous_[i]] = next_[i];
    previous_[next_[i]] = previous_[i];
    --left_;
  }

  std::vector<Vec2d> p_;
  const std::vector<uint32_t>& corners_;
  std::vector<Triangle>& out_;
  size_t left_;
  std::vector<size_t> previous_, next_, reflex_;
  long long budget_ = 0;
};

} // namespace

void triangulate(const std::vector<Vec3d>& positions, const std::vector<uint32_t>& corners, std::vector<Triangle>& out) {
  if (corners.size() < 3) return;
  if (corners.size() == 3) {
    out.push_back({corners[0], corners[1], corners[2]});
    return;
  }
  EarClipper(project(positions, corners), corners, out).clip();
}

} // namespace kelpie
