#include "renderer/mesh/self_intersections.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "field/mesh/triangle_tree.h"

namespace kelpie {

namespace {

/// In steps of the lattice: differences take 24 bits, volumes 74.
using ExactPoint = std::array<int64_t, 3>;
__extension__ using Wide = __int128;

ExactPoint operator-(const ExactPoint& a, const ExactPoint& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
ExactPoint cross(const ExactPoint& a, const ExactPoint& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
int sign_of(Wide v) { return (v > 0) - (v < 0); }
int sign_of_dot(const ExactPoint& a, const ExactPoint& b) { return sign_of(Wide(a[0]) * b[0] + Wide(a[1]) * b[1] + Wide(a[2]) * b[2]); }

/// The side of the plane through a, b, c on which d lies.
int side(const ExactPoint& a, const ExactPoint& b, const ExactPoint& c, const ExactPoint& d) {
  return sign_of_dot(cross(b - a, c - a), d - a);
}

/// What lies in one plane, seen along an axis to which the plane is not parallel.
struct Flat {
  size_t x, y;
  int turn(const ExactPoint& a, const ExactPoint& b, const ExactPoint& c) const {
    return sign_of(Wide(b[x] - a[x]) * (c[y] - a[y]) - Wide(b[y] - a[y]) * (c[x] - a[x]));
  }
  bool is_between(const ExactPoint& a, const ExactPoint& b, const ExactPoint& p) const {
    return std::min(a[x], b[x]) <= p[x] && p[x] <= std::max(a[x], b[x]) && std::min(a[y], b[y]) <= p[y] && p[y] <= std::max(a[y], b[y]);
  }
  bool do_meet(const ExactPoint& a, const ExactPoint& b, const ExactPoint& c, const ExactPoint& d) const {
    const int abc = turn(a, b, c), abd = turn(a, b, d), cda = turn(c, d, a), cdb = turn(c, d, b);
    if (abc * abd < 0 && cda * cdb < 0) return true;
    return (abc == 0 && is_between(a, b, c)) || (abd == 0 && is_between(a, b, d)) || (cda == 0 && is_between(c, d, a)) ||
           (cdb == 0 && is_between(c, d, b));
  }
};

using ExactCorners = std::array<ExactPoint, 3>;

Flat flat_of(const ExactCorners& t) {
  const ExactPoint normal = cross(t[1] - t[0], t[2] - t[0]);
  if (normal[2] != 0) return {0, 1};
  return normal[1] != 0 ? Flat{2, 0} : Flat{1, 2};
}

/// Whether a triangle and a segment have a point in common.
bool do_meet(const ExactCorners& t, const ExactPoint& p, const ExactPoint& q) {
  const int of_p = side(t[0], t[1], t[2], p), of_q = side(t[0], t[1], t[2], q);
  if (of_p * of_q > 0) return false;
  if (of_p == 0 && of_q == 0) {
    const Flat flat = flat_of(t);
    for (size_t i = 0; i < 3; ++i)
      if (flat.do_meet(p, q, t[i], t[(i + 1) % 3])) return true;
    const int first = flat.turn(t[0], t[1], p);
    return first == flat.turn(t[1], t[2], p) && first == flat.turn(t[2], t[0], p);
  }
  const int a = side(p, q, t[0], t[1]), b = side(p, q, t[1], t[2]), c = side(p, q, t[2], t[0]);
  return (a >= 0 && b >= 0 && c >= 0) || (a <= 0 && b <= 0 && c <= 0);
}

class PairTest {
public:
  PairTest(const Mesh& mesh, const ExactLattice& lattice) : triangles_(mesh.triangles) {
    for (const Vec3d& p : mesh.positions) {
      const Vec3d n = glm::round(p / lattice.step());
      points_.push_back({int64_t(n.x), int64_t(n.y), int64_t(n.z)});
    }
  }

  bool has_no_area(uint32_t triangle) const {
    const ExactCorners t = corners(triangles_[triangle]);
    return cross(t[1] - t[0], t[2] - t[0]) == ExactPoint{0, 0, 0};
  }

  bool do_meet(uint32_t first, uint32_t second) const {
    Triangle a = triangles_[first], b = triangles_[second];
    const size_t shared = bring_shared_to_front(a, b);
    const ExactCorners s = corners(a), t = corners(b);
    switch (shared) {
    case 0: return crosses(s, t) || crosses(t, s);
    case 1: return kelpie::do_meet(t, s[1], s[2]) || kelpie::do_meet(s, t[1], t[2]); // the sides opposite of the vertex
    case 2: return is_folded(s, t);
    default: return true;
    }
  }

private:
  ExactCorners corners(const Triangle& t) const { return {points_[t[0]], points_[t[1]], points_[t[2]]}; }

  static size_t bring_shared_to_front(Triangle& a, Triangle& b) {
    size_t shared = 0;
    for (size_t i = 0; i < 3; ++i)
      if (const auto at = std::find(b.begin(), b.end(), a[i]); at != b.end()) {
        std::swap(b[shared], *at);
        std::swap(a[shared++], a[i]);
      }
    return shared;
  }

  static bool crosses(const ExactCorners& s, const ExactCorners& t) {
    return kelpie::do_meet(t, s[0], s[1]) || kelpie::do_meet(t, s[1], s[2]) || kelpie::do_meet(t, s[2], s[0]);
  }

  /// Of two triangles that share their first two corners: in one plane, and on one side.
  static bool is_folded(const ExactCorners& s, const ExactCorners& t) {
    if (side(s[0], s[1], s[2], t[2]) != 0) return false;
    const Flat flat = flat_of(s);
    return flat.turn(s[0], s[1], s[2]) == flat.turn(s[0], s[1], t[2]);
  }

  const std::vector<Triangle>& triangles_;
  std::vector<ExactPoint> points_;
};

} // namespace

ExactLattice::ExactLattice(const Box3d& box) {
  if (box.is_empty()) return;
  double largest = 0;
  for (int axis = 0; axis < 3; ++axis) largest = std::max({largest, std::abs(box.lower[axis]), std::abs(box.upper[axis])});
  if (largest > 0) step_ = std::ldexp(1.0, std::ilogb(largest) - 21);
}

std::vector<TrianglePair> self_intersections(const Mesh& mesh, const ExactLattice& lattice) {
  constexpr size_t k_block = 1024;
  const TriangleTree tree(mesh);
  const PairTest test(mesh, lattice);
  std::vector<std::vector<TrianglePair>> lists((mesh.triangles.size() + k_block - 1) / k_block);
  parallel_for(size_t(0), lists.size(), [&](size_t block) {
    const size_t end = std::min(mesh.triangles.size(), (block + 1) * k_block);
    for (auto i = static_cast<uint32_t>(block * k_block); i < end; ++i) {
      if (test.has_no_area(i)) {
        lists[block].emplace_back(i, i);
        continue;
      }
      Box3d box;
      for (const uint32_t corner : mesh.triangles[i]) box.extend(mesh.positions[corner]);
      tree.for_each_near(box, [&](uint32_t other) {
        if (other > i && !test.has_no_area(other) && test.do_meet(i, other)) lists[block].emplace_back(i, other);
      });
    }
  });
  std::vector<TrianglePair> all;
  for (const std::vector<TrianglePair>& list : lists) all.insert(all.end(), list.begin(), list.end());
  std::sort(all.begin(), all.end());
  return all;
}

} // namespace kelpie
