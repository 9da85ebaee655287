#include "field/mesh/surface.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/file_bytes.h"
#include "field/mesh/formats.h"
#include "field/mesh/weld.h"

namespace kelpie {

namespace {

/// Around a vertex of more triangles than this every one keeps its own normal: comparing all with all takes too long.
constexpr size_t k_most_around_vertex = 1000;

Vec3d area_vector(const std::vector<Vec3d>& p, const Triangle& t) { return glm::cross(p[t[1]] - p[t[0]], p[t[2]] - p[t[0]]); }

double angle_between(const Vec3d& a, const Vec3d& b) { return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b)); }

/// A corner of a triangle, by number: 3 * triangle + corner.
using Corner = uint32_t;

class NormalMaker {
public:
  NormalMaker(SurfaceMesh& mesh, double crease) : mesh_(mesh), least_cosine_(std::cos(glm::radians(crease))) {
    for (const Triangle& t : mesh_.triangles) faces_.push_back(glm::normalize(area_vector(mesh_.positions, t)));
  }

  void run() {
    mesh_.normals.resize(mesh_.triangles.size());
    std::vector<Corner> corners(3 * mesh_.triangles.size());
    for (Corner c = 0; c < corners.size(); ++c) corners[c] = c;
    std::sort(corners.begin(), corners.end(), [&](Corner a, Corner b) { return std::pair(vertex(a), a) < std::pair(vertex(b), b); });
    for (size_t i = 0; i < corners.size();) {
      size_t j = i;
      while (j < corners.size() && vertex(corners[j]) == vertex(corners[i])) ++j;
      around_vertex(corners.data() + i, corners.data() + j);
      i = j;
    }
  }

private:
  uint32_t vertex(Corner c) const { return mesh_.triangles[c / 3][c % 3]; }

  double angle_at(Corner c) const {
    const Triangle& t = mesh_.triangles[c / 3];
    const Vec3d& at = mesh_.positions[t[c % 3]];
    return angle_between(mesh_.positions[t[(c + 1) % 3]] - at, mesh_.positions[t[(c + 2) % 3]] - at);
  }

  void around_vertex(const Corner* first, const Corner* last) {
    const bool is_crowded = size_t(last - first) > k_most_around_vertex;
    for (const Corner* c = first; c != last; ++c) {
      const Vec3d& own = faces_[*c / 3];
      Vec3d sum(0);
      if (!is_crowded)
        for (const Corner* other = first; other != last; ++other)
          if (glm::dot(own, faces_[*other / 3]) >= least_cosine_) sum += angle_at(*other) * faces_[*other / 3];
      // Where all cancel out, or the mean looks away, the triangle's own will do.
      mesh_.normals[*c / 3][*c % 3] = Vec3(glm::dot(sum, own) > 1e-3 * glm::length(sum) ? glm::normalize(sum) : own);
    }
  }

  SurfaceMesh& mesh_;
  double least_cosine_;
  std::vector<Vec3d> faces_; ///< unit normals of the triangles
};

} // namespace

SurfaceMesh make_surface_mesh(std::vector<Vec3d> positions, std::vector<Triangle> triangles, const SurfaceOptions& options,
                              const std::string& file, Diagnostics& diagnostics) {
  const std::vector<uint32_t> first = first_at_same_place(positions);
  for (Triangle& t : triangles)
    for (uint32_t& v : t) v = first[v];
  weld_borders(positions, triangles, options.weld, file, diagnostics);
  SurfaceMesh mesh;
  Box3d box;
  for (const Triangle& t : triangles)
    for (const uint32_t v : t) box.extend(positions[v]);
  mesh.origin = box.centre();
  for (Vec3d& p : positions) p -= mesh.origin;
  mesh.positions = std::move(positions);
  const double negligible = 1e-30 * box.diagonal() * box.diagonal(); // a normal needs some area
  for (const Triangle& t : triangles)
    if (glm::length(area_vector(mesh.positions, t)) > negligible) mesh.triangles.push_back(t);
  if (mesh.triangles.empty()) throw Error(ExitStatus::bad_data, "the mesh has no triangle with an area", {file, 0, 0});
  NormalMaker(mesh, options.crease).run();
  return mesh;
}

SurfaceMesh load_surface_mesh(const std::string& path, const SurfaceOptions& options, Diagnostics& diagnostics) {
  std::vector<Vec3d> positions;
  std::vector<Triangle> triangles;
  read_triangles(read_file_bytes(path), path, diagnostics, positions, triangles);
  return make_surface_mesh(std::move(positions), std::move(triangles), options, path, diagnostics);
}

} // namespace kelpie
