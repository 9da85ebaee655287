#include "field/mesh/curved.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include <opensubdiv/far/error.h>
#include <opensubdiv/far/primvarRefiner.h>
#include <opensubdiv/far/topologyDescriptor.h>

#include "field/mesh/edges.h"

namespace kelpie {

namespace {

namespace Far = OpenSubdiv::Far;
namespace Sdc = OpenSubdiv::Sdc;

constexpr int k_most_levels = 3;

/// A place as OpenSubdiv has it.
struct Vertex {
  Vec3d place{0};
  void Clear() { place = Vec3d(0); }
  void AddWithWeight(const Vertex& v, double weight) { place += weight * v.place; }
};

Vec3d unit_normal(const Mesh& mesh, uint32_t triangle) {
  const Triangle& t = mesh.triangles[triangle];
  const Vec3d n = glm::cross(mesh.positions[t[1]] - mesh.positions[t[0]], mesh.positions[t[2]] - mesh.positions[t[0]]);
  const double length = glm::length(n);
  return length > 0 ? n / length : Vec3d(0);
}

/// The ends of all edges at which triangles meet at more than `crease` degrees, one after the other.
std::vector<int> sharp_edges(const Mesh& mesh, double crease) {
  const double least_cosine = std::cos(glm::radians(crease));
  std::vector<int> ends;
  for_each_edge(sorted_half_edges(mesh.triangles), [&](const HalfEdge* first, const HalfEdge* last) {
    if (last - first != 2) return; // borders are sharp anyway
    const Vec3d a = unit_normal(mesh, first[0].triangle), b = unit_normal(mesh, first[1].triangle);
    if (glm::dot(a, b) < least_cosine) ends.push_back(static_cast<int>(first->low)), ends.push_back(static_cast<int>(first->high));
  });
  return ends;
}

std::unique_ptr<Far::TopologyRefiner> make_refiner(const Mesh& mesh, double crease) {
  std::vector<int> corners, sizes(mesh.triangles.size(), 3), sharp = sharp_edges(mesh, crease);
  for (const Triangle& t : mesh.triangles)
    for (const uint32_t v : t) corners.push_back(static_cast<int>(v));
  std::vector<float> sharpness(sharp.size() / 2, Sdc::Crease::SHARPNESS_INFINITE);
  Far::TopologyDescriptor cage;
  cage.numVertices = static_cast<int>(mesh.positions.size()), cage.numFaces = static_cast<int>(sizes.size());
  cage.numVertsPerFace = sizes.data(), cage.vertIndicesPerFace = corners.data();
  cage.numCreases = static_cast<int>(sharpness.size()), cage.creaseVertexIndexPairs = sharp.data(), cage.creaseWeights = sharpness.data();
  Sdc::Options options;
  options.SetVtxBoundaryInterpolation(Sdc::Options::VTX_BOUNDARY_EDGE_AND_CORNER);
  using Factory = Far::TopologyRefinerFactory<Far::TopologyDescriptor>;
  Far::SetErrorCallback([](Far::ErrorType, const char*) {});
  Far::SetWarningCallback([](const char*) {});
  return std::unique_ptr<Far::TopologyRefiner>(Factory::Create(cage, Factory::Options(Sdc::SCHEME_LOOP, options)));
}

double mean_edge(const Mesh& mesh) {
  double sum = 0;
  for (const Triangle& t : mesh.triangles)
    for (size_t i = 0; i < 3; ++i) sum += glm::distance(mesh.positions[t[i]], mesh.positions[t[(i + 1) % 3]]);
  return sum / double(3 * mesh.triangles.size());
}

} // namespace

Mesh curved_mesh(const Mesh& mesh, double crease, double edge, const std::string& file) {
  const int levels = static_cast<int>(std::clamp(std::ceil(std::log2(mean_edge(mesh) / edge)), 1.0, double(k_most_levels)));
  const auto refiner = make_refiner(mesh, crease);
  if (!refiner) throw Error(ExitStatus::bad_data, "the triangles do not fit together to a surface that can be smooth", {file, 0, 0});
  Far::TopologyRefiner::UniformOptions how(levels);
  how.fullTopologyInLastLevel = true; // else limits are not known there
  refiner->RefineUniform(how);
  const Far::PrimvarRefinerReal<double> primvars(*refiner);
  std::vector<Vertex> vertices;
  for (const Vec3d& p : mesh.positions) vertices.push_back({p});
  for (int level = 1; level <= levels; ++level) {
    std::vector<Vertex> finer(static_cast<size_t>(refiner->GetLevel(level).GetNumVertices()));
    primvars.Interpolate(level, vertices, finer);
    vertices = std::move(finer);
  }
  std::vector<Vertex> limits(vertices.size());
  primvars.Limit(vertices, limits);
  Mesh curved;
  curved.origin = mesh.origin;
  for (const Vertex& v : limits) curved.positions.push_back(v.place);
  const Far::TopologyLevel topology = refiner->GetLevel(levels);
  for (int f = 0; f < topology.GetNumFaces(); ++f) {
    const Far::ConstIndexArray c = topology.GetFaceVertices(f);
    curved.triangles.push_back({uint32_t(c[0]), uint32_t(c[1]), uint32_t(c[2])});
  }
  return curved;
}

} // namespace kelpie
