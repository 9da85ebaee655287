#include "renderer/mesh/survey.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "base/parallel.h"
#include "field/mesh/orient.h"
#include "field/mesh/triangle_tree.h"

namespace kelpie {

namespace {

Vec3d vector_area(const Mesh& mesh, const Triangle& t) {
  const Vec3d& a = mesh.positions[t[0]];
  return 0.5 * glm::cross(mesh.positions[t[1]] - a, mesh.positions[t[2]] - a);
}

void find_pieces(const Mesh& mesh, Survey& out) {
  std::vector<Triangle> triangles = mesh.triangles;
  const Components components = orient_consistently(triangles);
  std::vector<Piece> all(components.count);
  for (size_t i = 0; i < mesh.triangles.size(); ++i) {
    Piece& piece = all[components.of_triangle[i]];
    piece.volume += glm::dot(mesh.positions[mesh.triangles[i][0]], vector_area(mesh, mesh.triangles[i])) / 3;
    for (const uint32_t corner : mesh.triangles[i]) piece.box.extend(mesh.positions[corner]);
  }
  std::stable_sort(all.begin(), all.end(), [](const Piece& a, const Piece& b) { return std::abs(a.volume) > std::abs(b.volume); });
  for (const Piece& piece : all) (piece.volume > 0 ? out.pieces : out.cavities).push_back(piece);
}

/// The wall behind a place of the surface.
struct Wall {
  double thickness;
  Vec3d middle;
};

/// Places at equal steps of the area, in the order of the triangles; where in a triangle, as Halton's sequence says.
class WallSampler {
public:
  WallSampler(const Mesh& mesh, const TriangleTree& tree) : mesh_(mesh), tree_(tree), area_before_(mesh.triangles.size() + 1) {
    for (size_t i = 0; i < mesh.triangles.size(); ++i)
      area_before_[i + 1] = area_before_[i] + glm::length(vector_area(mesh, mesh.triangles[i]));
  }
  double area() const { return area_before_.back(); }

  Wall wall(size_t sample, size_t count) const {
    const double wanted = (double(sample) + 0.5) / double(count) * area();
    const auto at = std::upper_bound(area_before_.begin(), area_before_.end(), wanted) - area_before_.begin() - 1;
    const Triangle& t = mesh_.triangles[std::min(size_t(at), mesh_.triangles.size() - 1)];
    const double root = std::sqrt(halton(sample, 2)), v = halton(sample, 3);
    const Vec3d p = (1 - root) * mesh_.positions[t[0]] + root * (1 - v) * mesh_.positions[t[1]] + root * v * mesh_.positions[t[2]];
    const Vec3d inward = -glm::normalize(vector_area(mesh_, t));
    const double thickness = tree_.way_out(p, inward, k_most_turned);
    return {thickness, p + 0.5 * thickness * inward};
  }

private:
  static constexpr double k_most_turned = 0.5; ///< the cosine of 60 degrees

  static double halton(size_t i, size_t base) {
    double part = 1, value = 0;
    for (++i; i > 0; i /= base) part /= double(base), value += part * double(i % base);
    return value;
  }

  const Mesh& mesh_;
  const TriangleTree& tree_;
  std::vector<double> area_before_;
};

} // namespace

Survey survey(const Mesh& mesh) {
  constexpr size_t k_samples = 20'000, k_thinner = k_samples / 1000;
  Survey out;
  out.volume = signed_volume(mesh), out.box = bounding_box(mesh);
  find_pieces(mesh, out);
  const TriangleTree tree(mesh);
  const WallSampler sampler(mesh, tree);
  out.area = sampler.area();
  std::vector<Wall> walls(k_samples);
  parallel_for(size_t(0), k_samples, [&](size_t i) { walls[i] = sampler.wall(i, k_samples); });
  std::nth_element(walls.begin(), walls.begin() + k_thinner, walls.end(),
                   [](const Wall& a, const Wall& b) { return a.thickness < b.thickness; });
  out.thinnest = walls[k_thinner].thickness, out.thinnest_at = walls[k_thinner].middle;
  return out;
}

bool has_single_rings(const Mesh& mesh) {
  // From each corner of a triangle to that of the next around the vertex: over the edge that leads to it.
  std::map<std::pair<uint32_t, uint32_t>, uint32_t> next; // (vertex, before) -> after
  std::vector<size_t> corners(mesh.positions.size());
  for (const Triangle& t : mesh.triangles)
    for (size_t i = 0; i < 3; ++i) next[{t[i], t[(i + 1) % 3]}] = t[(i + 2) % 3], ++corners[t[i]];
  for (auto at = next.begin(); at != next.end();) {
    const auto [vertex, start] = at->first;
    size_t steps = 0;
    uint32_t now = start;
    do {
      const auto found = next.find({vertex, now});
      if (found == next.end()) return false;
      now = found->second;
    } while (++steps < corners[vertex] && now != start);
    if (now != start || steps != corners[vertex]) return false;
    at = next.upper_bound({vertex, ~0u});
  }
  return true;
}

} // namespace kelpie
