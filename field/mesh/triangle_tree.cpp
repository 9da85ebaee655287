#include "field/mesh/triangle_tree.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace kelpie {

namespace {

constexpr size_t k_leaf_triangles = 6;
constexpr int k_most_depth = 60;
/// A cluster farther away than this many of its radii is one dipole: an error of a few thousandths for each, of either sign.
constexpr double k_far_in_radii = 2.3;

double squared(const Vec3d& v) { return glm::dot(v, v); }

double squared_distance(const Box3d& box, const Vec3d& p) { return squared(glm::max(Vec3d(0), glm::max(box.lower - p, p - box.upper))); }

/// Ericson, "Real-Time Collision Detection" (2005), section 5.1.5.
double squared_distance(const std::array<Vec3d, 3>& t, const Vec3d& p) {
  const Vec3d ab = t[1] - t[0], ac = t[2] - t[0], ap = p - t[0];
  const double d1 = glm::dot(ab, ap), d2 = glm::dot(ac, ap);
  if (d1 <= 0 && d2 <= 0) return squared(ap);
  const Vec3d bp = p - t[1];
  const double d3 = glm::dot(ab, bp), d4 = glm::dot(ac, bp);
  if (d3 >= 0 && d4 <= d3) return squared(bp);
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return squared(ap - ab * (d1 > d3 ? d1 / (d1 - d3) : 0));
  const Vec3d cp = p - t[2];
  const double d5 = glm::dot(ab, cp), d6 = glm::dot(ac, cp);
  if (d6 >= 0 && d5 <= d6) return squared(cp);
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return squared(ap - ac * (d2 > d6 ? d2 / (d2 - d6) : 0));
  const double va = d3 * d6 - d5 * d4, along = d4 - d3, back = d5 - d6;
  if (va <= 0 && along >= 0 && back >= 0) return squared(bp - (t[2] - t[1]) * (along + back > 0 ? along / (along + back) : 0));
  const double sum = va + vb + vc;
  return squared(ap - ab * (vb / sum) - ac * (vc / sum));
}

/// Where a ray enters a box (not before its origin); infinite where it misses it or all of it lies beyond `most`.
double way_to(const Box3d& box, const Vec3d& origin, const Vec3d& inverse, double most) {
  double near = 0, far = most;
  for (int axis = 0; axis < 3; ++axis) {
    const double a = (box.lower[axis] - origin[axis]) * inverse[axis], b = (box.upper[axis] - origin[axis]) * inverse[axis];
    near = std::fmax(near, std::fmin(a, b)), far = std::fmin(far, std::fmax(a, b)); // a ray in a side's plane makes no number of it
  }
  return near <= far ? near : std::numeric_limits<double>::infinity();
}

/// Moeller and Trumbore (1997), of triangles seen from behind.
double way_out_of(const std::array<Vec3d, 3>& t, const Vec3d& origin, const Vec3d& direction, double least_cosine) {
  const Vec3d ab = t[1] - t[0], ac = t[2] - t[0], normal = glm::cross(ab, ac), from = origin - t[0];
  const double along = glm::dot(direction, normal), none = std::numeric_limits<double>::infinity();
  if (!(along > 0 && along >= least_cosine * glm::length(normal))) return none;
  const Vec3d turned = glm::cross(direction, from);
  const double u = glm::dot(ac, turned), v = -glm::dot(ab, turned);
  const double way = -glm::dot(from, normal);
  return u >= 0 && v >= 0 && u + v <= along && way > 0 ? way / along : none;
}

} // namespace

double distance_to_triangle(const std::array<Vec3d, 3>& triangle, const Vec3d& p) { return std::sqrt(squared_distance(triangle, p)); }

TriangleTree::TriangleTree(const Mesh& mesh) {
  for (const Triangle& t : mesh.triangles)
    triangles_.push_back({{mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]]}, static_cast<uint32_t>(triangles_.size())});
  nodes_.reserve(2 * triangles_.size() / k_leaf_triangles + 2);
  nodes_.emplace_back();
  build(0, 0, triangles_.size(), 0);
}

void TriangleTree::build(uint32_t index, size_t first, size_t count, int depth) {
  Node node;
  Box3d centres;
  double area = 0;
  Vec3d mean(0);
  for (size_t i = first; i < first + count; ++i) {
    const auto& [a, b, c] = triangles_[i].corners;
    const Vec3d vector_area = 0.5 * glm::cross(b - a, c - a), centre = (a + b + c) / 3.0;
    node.box.extend(a), node.box.extend(b), node.box.extend(c), centres.extend(centre);
    node.area += vector_area, area += glm::length(vector_area), mean += centre * glm::length(vector_area);
  }
  node.centre = area > 0 ? mean / area : node.box.centre();
  for (size_t i = first; i < first + count; ++i)
    for (const Vec3d& corner : triangles_[i].corners) node.radius = std::max(node.radius, glm::distance(corner, node.centre));
  const Vec3d extent = centres.is_empty() ? Vec3d(0) : centres.extent();
  const int axis = extent.x >= extent.y && extent.x >= extent.z ? 0 : extent.y >= extent.z ? 1 : 2;
  if (count <= k_leaf_triangles || !(extent[axis] > 0) || depth >= k_most_depth) {
    node.first = static_cast<uint32_t>(first), node.count = static_cast<uint32_t>(count);
    nodes_[index] = node;
    return;
  }
  const size_t half = count / 2;
  const auto begin = triangles_.begin() + static_cast<std::ptrdiff_t>(first);
  const auto along = [axis](const Placed& t) { return t.corners[0][axis] + t.corners[1][axis] + t.corners[2][axis]; };
  std::nth_element(begin, begin + static_cast<std::ptrdiff_t>(half), begin + static_cast<std::ptrdiff_t>(count),
                   [&](const auto& a, const auto& b) { return along(a) < along(b); });
  node.first = static_cast<uint32_t>(nodes_.size());
  nodes_[index] = node;
  nodes_.resize(nodes_.size() + 2);
  build(node.first, first, half, depth + 1);
  build(node.first + 1, first + half, count - half, depth + 1);
}

double TriangleTree::distance(const Vec3d& p, double most) const {
  double nearest = most * most;
  std::array<uint32_t, k_most_depth + 8> stack;
  size_t depth = 0;
  stack[depth++] = 0;
  while (depth > 0) {
    const Node& node = nodes_[stack[--depth]];
    if (squared_distance(node.box, p) >= nearest) continue;
    if (node.count > 0 || nodes_.size() == 1) {
      for (uint32_t i = node.first; i < node.first + node.count; ++i)
        nearest = std::min(nearest, squared_distance(triangles_[i].corners, p));
      continue;
    }
    const bool is_first_nearer = squared_distance(nodes_[node.first].box, p) < squared_distance(nodes_[node.first + 1].box, p);
    stack[depth++] = node.first + is_first_nearer; // the nearer one is looked at first
    stack[depth++] = node.first + !is_first_nearer;
  }
  return std::sqrt(nearest);
}

double TriangleTree::way_out(const Vec3d& origin, const Vec3d& direction, double least_cosine) const {
  const Vec3d inverse = 1.0 / direction;
  double nearest = std::numeric_limits<double>::infinity();
  std::array<uint32_t, k_most_depth + 8> stack;
  size_t depth = 0;
  stack[depth++] = 0;
  while (depth > 0) {
    const Node& node = nodes_[stack[--depth]];
    if (!(way_to(node.box, origin, inverse, nearest) < nearest)) continue;
    if (node.count > 0 || nodes_.size() == 1) {
      for (uint32_t i = node.first; i < node.first + node.count; ++i)
        nearest = std::min(nearest, way_out_of(triangles_[i].corners, origin, direction, least_cosine));
      continue;
    }
    const double first = way_to(nodes_[node.first].box, origin, inverse, nearest);
    const bool is_first_nearer = first < way_to(nodes_[node.first + 1].box, origin, inverse, nearest);
    stack[depth++] = node.first + is_first_nearer; // the nearer one is looked at first
    stack[depth++] = node.first + !is_first_nearer;
  }
  return nearest;
}

/// Of the triangles of a leaf: van Oosterom and Strackee (1983).
double TriangleTree::solid_angle(const Node& node, const Vec3d& p) const {
  double sum = 0;
  for (uint32_t i = node.first; i < node.first + node.count; ++i) {
    const auto& corners = triangles_[i].corners;
    const Vec3d a = corners[0] - p, b = corners[1] - p, c = corners[2] - p;
    const double la = glm::length(a), lb = glm::length(b), lc = glm::length(c);
    const double numerator = glm::dot(a, glm::cross(b, c));
    const double denominator = la * lb * lc + glm::dot(a, b) * lc + glm::dot(b, c) * la + glm::dot(c, a) * lb;
    if (numerator != 0 || denominator < 0) sum += 2 * std::atan2(numerator, denominator);
  }
  return sum;
}

double TriangleTree::winding(const Vec3d& p) const {
  double sum = 0;
  std::array<uint32_t, k_most_depth + 8> stack;
  size_t depth = 0;
  stack[depth++] = 0;
  while (depth > 0) {
    const Node& node = nodes_[stack[--depth]];
    const Vec3d away = node.centre - p;
    const double distance = glm::length(away);
    if (distance > k_far_in_radii * node.radius && distance > 0) {
      sum += glm::dot(node.area, away) / (distance * distance * distance);
    } else if (node.count > 0 || nodes_.size() == 1) {
      sum += solid_angle(node, p);
    } else {
      stack[depth++] = node.first;
      stack[depth++] = node.first + 1;
    }
  }
  return sum / (4 * std::numbers::pi);
}

} // namespace kelpie
