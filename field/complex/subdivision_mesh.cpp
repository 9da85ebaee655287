#include "field/complex/subdivision_mesh.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include <fmt/format.h>
#include <opensubdiv/far/error.h>
#include <opensubdiv/far/primvarRefiner.h>
#include <opensubdiv/far/topologyDescriptor.h>

#include "base/file_bytes.h"
#include "field/files/ply.h"
#include "field/mesh/formats.h"

namespace kelpie {

namespace {

namespace Far = OpenSubdiv::Far;

/// What is refined: a place (x, y, z) and the thickness, as OpenSubdiv has it.
struct CageVertex {
  glm::dvec4 value{0};
  void Clear() { value = glm::dvec4(0); }
  void AddWithWeight(const CageVertex& v, double weight) { value += weight * v.value; }
};

using Refiner = std::unique_ptr<Far::TopologyRefiner>;

void check(const PolygonSoup& soup, const std::string& path) {
  if (soup.face_count() == 0) throw Error(ExitStatus::bad_data, "the mesh has no faces", {path, 0, 0});
  for (size_t f = 0; f < soup.face_count(); ++f) {
    std::vector<uint32_t> corners(soup.corners.begin() + std::ptrdiff_t(soup.face_begin(f)),
                                  soup.corners.begin() + std::ptrdiff_t(soup.face_ends[f]));
    std::sort(corners.begin(), corners.end());
    if (corners.size() < 3 || std::adjacent_find(corners.begin(), corners.end()) != corners.end())
      throw Error(ExitStatus::bad_data, fmt::format("face {} has not three different corners or more", f),
                  {path, soup.lines.empty() ? 0 : soup.lines[f], 0});
  }
}

Refiner make_refiner(const PolygonSoup& soup, const std::string& path) {
  std::vector<int> sizes, corners(soup.corners.begin(), soup.corners.end());
  for (size_t f = 0; f < soup.face_count(); ++f) sizes.push_back(static_cast<int>(soup.face_ends[f] - soup.face_begin(f)));
  Far::TopologyDescriptor cage;
  cage.numVertices = static_cast<int>(soup.positions.size()), cage.numFaces = static_cast<int>(sizes.size());
  cage.numVertsPerFace = sizes.data(), cage.vertIndicesPerFace = corners.data();
  OpenSubdiv::Sdc::Options options;
  options.SetVtxBoundaryInterpolation(OpenSubdiv::Sdc::Options::VTX_BOUNDARY_EDGE_AND_CORNER);
  using Factory = Far::TopologyRefinerFactory<Far::TopologyDescriptor>;
  Factory::Options how(OpenSubdiv::Sdc::SCHEME_CATMARK, options);
  how.validateFullTopology = true;
  // What it has to say is said below.
  Far::SetErrorCallback([](Far::ErrorType, const char*) {});
  Far::SetWarningCallback([](const char*) {});
  Refiner refiner(Factory::Create(cage, how));
  if (!refiner) throw Error(ExitStatus::bad_data, "the faces do not fit together to a surface that can be subdivided", {path, 0, 0});
  return refiner;
}

/// The property `thickness` of a PLY's vertices.
void read_thickness(std::string_view bytes, const std::string& path, std::vector<CageVertex>& cage) {
  if (!is_ply(bytes)) return;
  const PlyHeader header = read_ply_header(bytes, path);
  size_t i = 0;
  read_ply_rows(bytes, path, header, [&](const PlyElement& e, const PlyRow& row) {
    if (e.name != "vertex" || e.column("thickness") < 0) return;
    const double t = row.scalars[static_cast<size_t>(e.column("thickness"))];
    if (!(t >= 0 && t < 1e30))
      throw Error(ExitStatus::bad_data, fmt::format("vertex {}: thickness must be >= 0, found {}", i, t), {path, 0, 0});
    cage[i++].value.w = t;
  });
}

Vec3 unit(const Vec3d& v) {
  const double length = glm::length(v);
  return length > 0 ? Vec3(v / length) : Vec3(0);
}

SubdivisionMesh::Level make_level(const Far::TopologyRefiner& refiner, const std::vector<CageVertex>& refined) {
  const Far::TopologyLevel topology = refiner.GetLevel(refiner.GetMaxLevel());
  std::vector<CageVertex> at(refined.size()), by_u(refined.size()), by_v(refined.size());
  Far::PrimvarRefinerReal<double>(refiner).Limit(refined, at, by_u, by_v);
  SubdivisionMesh::Level level;
  for (size_t i = 0; i < at.size(); ++i) {
    level.positions.push_back(Vec3(at[i].value));
    level.normals.push_back(unit(glm::cross(Vec3d(by_u[i].value), Vec3d(by_v[i].value))));
    level.thickness.push_back(static_cast<float>(std::max(0.0, at[i].value.w)));
  }
  for (int f = 0; f < topology.GetNumFaces(); ++f) {
    const Far::ConstIndexArray c = topology.GetFaceVertices(f);
    level.faces.push_back({uint32_t(c[0]), uint32_t(c[1]), uint32_t(c[2]), uint32_t(c[3])}); // all are quadrangles by now
  }
  for (int e = 0; e < topology.GetNumEdges(); ++e)
    if (topology.GetEdgeFaces(e).size() != 2)
      level.borders.push_back({uint32_t(topology.GetEdgeVertices(e)[0]), uint32_t(topology.GetEdgeVertices(e)[1])});
  return level;
}

/// How far the vertices that the next level has for edges and faces of this one are from the middles of these.
double error_of(const SubdivisionMesh::Level& level, const SubdivisionMesh::Level& next, const Far::TopologyLevel& topology) {
  double most = 0;
  const auto compare = [&](int child, const Vec3& middle) {
    if (child >= 0) most = std::max(most, double(glm::distance(next.positions[size_t(child)], middle)));
  };
  for (int e = 0; e < topology.GetNumEdges(); ++e) {
    const Far::ConstIndexArray c = topology.GetEdgeVertices(e);
    compare(topology.GetEdgeChildVertex(e), 0.5f * (level.positions[size_t(c[0])] + level.positions[size_t(c[1])]));
  }
  for (int f = 0; f < topology.GetNumFaces(); ++f) {
    Vec3 sum(0);
    for (const uint32_t c : level.faces[size_t(f)]) sum += level.positions[c];
    compare(topology.GetFaceChildVertex(f), 0.25f * sum);
  }
  return most;
}

} // namespace

SubdivisionMesh load_subdivision_mesh(const std::string& path, int levels, Diagnostics& diagnostics) {
  const std::string bytes = read_file_bytes(path);
  const PolygonSoup soup = read_polygons(bytes, path, diagnostics);
  check(soup, path);
  if (soup.corners.size() * std::pow(4.0, levels - 1) > double(k_most_subdivided_faces))
    throw Error(ExitStatus::bad_data,
                fmt::format("{} levels of this mesh are more than {} faces: give fewer levels", levels, k_most_subdivided_faces),
                {path, 0, 0});
  std::vector<CageVertex> refined;
  for (const Vec3d& p : soup.positions) refined.push_back({{p, 1}});
  read_thickness(bytes, path, refined);
  SubdivisionMesh mesh;
  for (int level = 1; level <= levels; ++level) { // limits are known at a refiner's last level only
    Refiner refiner = make_refiner(soup, path);
    Far::TopologyRefiner::UniformOptions how(level);
    how.fullTopologyInLastLevel = true; // else limits and edges are not known there
    refiner->RefineUniform(how);
    std::vector<CageVertex> finer(static_cast<size_t>(refiner->GetLevel(level).GetNumVertices()));
    Far::PrimvarRefinerReal<double>(*refiner).Interpolate(level, refined, finer);
    refined = std::move(finer);
    mesh.levels.push_back(make_level(*refiner, refined));
    if (level > 1)
      mesh.levels[size_t(level) - 2].error = error_of(mesh.levels[size_t(level) - 2], mesh.levels.back(), refiner->GetLevel(level - 1));
  }
  mesh.levels.back().error = levels > 1 ? mesh.levels[size_t(levels) - 2].error / 4 : 0;
  for (const Vec3& p : mesh.levels.back().positions) mesh.box.extend(Vec3d(p));
  return mesh;
}

} // namespace kelpie
