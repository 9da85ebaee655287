#include "field/mesh/orient.h"

#include <algorithm>
#include <cmath>

#include "field/mesh/edges.h"

namespace kelpie {

namespace {

constexpr double k_pi = 3.14159265358979323846;

/// Cavities are looked for among at most this many components, and with this many solid angles: some
/// seconds. A soup of a million loose pieces has no cavities worth a day's wait.
constexpr size_t k_most_components = 10'000;
constexpr size_t k_most_angles = 100'000'000;

/// Across an edge: the triangle there, and whether the two run along the edge in the same direction.
struct Neighbour {
  uint32_t triangle;
  bool disagrees;
};

std::vector<std::vector<Neighbour>> manifold_neighbours(const std::vector<Triangle>& triangles) {
  std::vector<std::vector<Neighbour>> neighbours(triangles.size());
  for_each_edge(sorted_half_edges(triangles), [&](const HalfEdge* first, const HalfEdge* last) {
    if (last - first != 2) return;
    const bool disagrees = first[0].is_reversed == first[1].is_reversed;
    neighbours[first[0].triangle].push_back({first[1].triangle, disagrees});
    neighbours[first[1].triangle].push_back({first[0].triangle, disagrees});
  });
  return neighbours;
}

void turn(Triangle& t) { std::swap(t[1], t[2]); }

/// What is known of a component.
struct Body {
  std::vector<uint32_t> triangles;
  Box3d box;
  Vec3d point{0}; ///< one of its vertices
  /// Six times the volume between the triangles and the centre of `box`, and six times its change as that point moves: minus twice the
  /// sum of their area vectors.
  double volume = 0;
  Vec3d slope{0};
  bool is_closed = true; ///< every edge is run along as often in one direction as in the other
};

void add_volume(Body& body, const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& centre) {
  body.volume += glm::dot(a - centre, glm::cross(b - centre, c - centre));
  body.slope -= glm::cross(b - a, c - a);
}

std::vector<Body> bodies(const std::vector<Vec3d>& positions, const Components& components, const std::vector<Triangle>& triangles) {
  std::vector<Body> all(components.count);
  for (uint32_t t = 0; t < triangles.size(); ++t) {
    Body& b = all[components.of_triangle[t]];
    if (b.triangles.empty()) b.point = positions[triangles[t][0]];
    b.triangles.push_back(t);
    for (const uint32_t v : triangles[t]) b.box.extend(positions[v]);
  }
  for (Body& b : all)
    for (const uint32_t t : b.triangles)
      add_volume(b, positions[triangles[t][0]], positions[triangles[t][1]], positions[triangles[t][2]], b.box.centre());
  std::vector<std::pair<uint32_t, int>> runs; // along one edge, by component
  for_each_edge(sorted_half_edges(triangles), [&](const HalfEdge* first, const HalfEdge* last) {
    runs.clear();
    for (const HalfEdge* h = first; h != last; ++h) runs.emplace_back(components.of_triangle[h->triangle], h->is_reversed ? -1 : 1);
    std::sort(runs.begin(), runs.end());
    for (size_t i = 0, j = 0; i < runs.size(); i = j) {
      int sum = 0;
      for (j = i; j < runs.size() && runs[j].first == runs[i].first; ++j) sum += runs[j].second;
      if (sum != 0) all[runs[i].first].is_closed = false;
    }
  });
  return all;
}

/// How often the component winds around `p`: the sum of the solid angles (Van Oosterom and Strackee 1983) over 4 pi.
double winding(const Body& b, const Vec3d& p, const std::vector<Vec3d>& positions, const std::vector<Triangle>& triangles) {
  double angle = 0;
  for (const uint32_t t : b.triangles) {
    const Vec3d x = positions[triangles[t][0]] - p, y = positions[triangles[t][1]] - p, z = positions[triangles[t][2]] - p;
    const double lx = glm::length(x), ly = glm::length(y), lz = glm::length(z);
    angle += 2 * std::atan2(glm::dot(x, glm::cross(y, z)), lx * ly * lz + glm::dot(x, y) * lz + glm::dot(y, z) * lx + glm::dot(z, x) * ly);
  }
  return angle / (4 * k_pi);
}

/// For each component the largest closed one that it lies in; itself, if there is none.
std::vector<size_t> outermost(const std::vector<Body>& all, const std::vector<Vec3d>& positions, const std::vector<Triangle>& triangles) {
  std::vector<size_t> result(all.size());
  size_t angles = 0;
  for (size_t i = 0; i < all.size(); ++i) {
    result[i] = i;
    for (size_t j = 0; j < all.size() && all.size() <= k_most_components && angles < k_most_angles; ++j) {
      if (j == i || !all[j].is_closed || all[j].box.diagonal() <= all[result[i]].box.diagonal()) continue;
      if (!all[j].box.contains(all[i].box.lower) || !all[j].box.contains(all[i].box.upper)) continue;
      angles += all[j].triangles.size();
      if (std::abs(winding(all[j], all[i].point, positions, triangles)) > 0.5) result[i] = j;
    }
  }
  return result;
}

/// Whether the open components that lie in no other face inward as a whole.
bool do_open_ones_face_inward(const std::vector<Body>& all, const std::vector<size_t>& outer, const std::vector<Vec3d>& positions,
                              const std::vector<Triangle>& triangles) {
  Body joint;
  for (size_t i = 0; i < all.size(); ++i)
    if (!all[i].is_closed && outer[i] == i) joint.box.extend(all[i].box);
  for (size_t i = 0; i < all.size(); ++i)
    if (!all[i].is_closed && outer[i] == i)
      for (const uint32_t t : all[i].triangles)
        add_volume(joint, positions[triangles[t][0]], positions[triangles[t][1]], positions[triangles[t][2]], joint.box.centre());
  const Vec3d most = 0.5 * joint.box.extent() * glm::abs(joint.slope);
  return joint.volume + most.x + most.y + most.z < 0;
}

} // namespace

Components orient_consistently(std::vector<Triangle>& triangles) {
  constexpr uint32_t k_none = UINT32_MAX;
  const auto neighbours = manifold_neighbours(triangles);
  Components c;
  c.of_triangle.assign(triangles.size(), k_none);
  std::vector<char> is_turned(triangles.size(), 0);
  std::vector<uint32_t> members;
  for (uint32_t seed = 0; seed < triangles.size(); ++seed) {
    if (c.of_triangle[seed] != k_none) continue;
    members.assign(1, seed);
    c.of_triangle[seed] = c.count;
    size_t turned = 0;
    for (size_t i = 0; i < members.size(); ++i)
      for (const Neighbour& n : neighbours[members[i]]) {
        const char wanted = static_cast<char>(is_turned[members[i]] != n.disagrees);
        if (c.of_triangle[n.triangle] == k_none) {
          c.of_triangle[n.triangle] = c.count;
          is_turned[n.triangle] = wanted;
          turned += static_cast<size_t>(wanted);
          members.push_back(n.triangle);
        } else if (is_turned[n.triangle] != wanted) {
          ++c.contradictions; // met from both sides: counted twice
        }
      }
    const bool keep_seed = 2 * turned <= members.size();
    for (const uint32_t t : members)
      if ((is_turned[t] != 0) == keep_seed) turn(triangles[t]), ++c.turned;
    ++c.count;
  }
  c.contradictions /= 2;
  return c;
}

size_t orient_outward(const std::vector<Vec3d>& positions, const Components& components, std::vector<Triangle>& triangles) {
  const std::vector<Body> all = bodies(positions, components, triangles);
  const std::vector<size_t> outer = outermost(all, positions, triangles);
  const bool turn_open = do_open_ones_face_inward(all, outer, positions, triangles);
  size_t turned = 0;
  for (uint32_t t = 0; t < triangles.size(); ++t) {
    const Body& body = all[outer[components.of_triangle[t]]];
    if (body.is_closed ? body.volume < 0 : turn_open) turn(triangles[t]), ++turned;
  }
  return turned;
}

} // namespace kelpie
