#include "renderer/mesh/print_check.h"

#include <algorithm>

#include <fmt/format.h>

namespace kelpie {

namespace {

std::string text_of(const Vec3d& p) { return fmt::format("({:.4g}, {:.4g}, {:.4g})", p.x, p.y, p.z); }

/// All objects as one mesh, and the object of each triangle.
struct JoinedObjects {
  Mesh mesh;
  std::vector<size_t> object_of;

  explicit JoinedObjects(std::span<const MeshObject> objects) {
    for (size_t i = 0; i < objects.size(); ++i) {
      const auto first = static_cast<uint32_t>(mesh.positions.size());
      const Mesh& m = objects[i].mesh;
      mesh.positions.insert(mesh.positions.end(), m.positions.begin(), m.positions.end());
      for (const Triangle& t : m.triangles) mesh.triangles.push_back({first + t[0], first + t[1], first + t[2]});
      object_of.resize(mesh.triangles.size(), i);
    }
  }
};

/// One line for each two objects that meet, or one that meets itself.
void find_meetings(std::span<const MeshObject> objects, const ExactLattice& lattice, std::vector<std::string>& out) {
  const JoinedObjects joined(objects);
  std::vector<std::pair<size_t, size_t>> told;
  for (const auto& [a, b] : self_intersections(joined.mesh, lattice)) {
    const std::pair both(joined.object_of[a], joined.object_of[b]);
    if (std::find(told.begin(), told.end(), both) != told.end()) continue;
    told.push_back(both);
    const std::string place = text_of(joined.mesh.positions[joined.mesh.triangles[a][0]]);
    const std::string& name = objects[both.first].name;
    out.push_back(both.first == both.second
                      ? fmt::format("{} meets itself at {}", name, place)
                      : fmt::format("{} and {} meet at {}: a union in the scene makes one shape of them, --shape leaves one out", name,
                                    objects[both.second].name, place));
  }
}

void check_object(const MeshObject& object, const Survey& survey, const PrintLimits& limits, std::vector<std::string>& out) {
  if (!is_closed(object.mesh)) out.push_back(fmt::format("{} is not closed", object.name));
  if (!has_single_rings(object.mesh)) out.push_back(fmt::format("{} is not a manifold", object.name));
  if (survey.pieces.size() > limits.pieces)
    out.push_back(fmt::format("{} is in {} pieces, the smallest of {:.3g} mm3 at {}: --pieces permits more than {}", object.name,
                              survey.pieces.size(), survey.pieces.back().volume, text_of(survey.pieces.back().box.centre()),
                              limits.pieces));
  if (survey.thinnest < limits.wall)
    out.push_back(fmt::format("{} is {:.2g} mm thin at {}: --wall permits less than {:.2g}", object.name, survey.thinnest,
                              text_of(survey.thinnest_at), limits.wall));
}

} // namespace

std::vector<std::string> print_problems(std::span<const MeshObject> objects, std::span<const Survey> surveys, const ExactLattice& lattice,
                                        int up_axis, const PrintLimits& limits) {
  std::vector<std::string> out;
  Box3d box;
  for (size_t i = 0; i < objects.size(); ++i) {
    check_object(objects[i], surveys[i], limits, out);
    box.extend(surveys[i].box);
  }
  find_meetings(objects, lattice, out);
  const Vec3d extent = box.extent();
  const double height = extent[up_axis], width = extent.x, depth = extent[3 - up_axis];
  const auto fits = [&](double x, double y) { return x <= limits.volume.x && y <= limits.volume.y && height <= limits.volume.z; };
  if (!fits(width, depth) && !fits(depth, width))
    out.push_back(
        fmt::format("{:.4g} x {:.4g} mm and {:.4g} mm high is larger than {:.4g} x {:.4g} x {:.4g}: --size makes it smaller, --bed says "
                    "what there is",
                    width, depth, height, limits.volume.x, limits.volume.y, limits.volume.z));
  return out;
}

} // namespace kelpie
