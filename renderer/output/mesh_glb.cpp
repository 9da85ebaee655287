#include "renderer/output/mesh_glb.h"

#include <cmath>
#include <cstring>
#include <map>
#include <sstream>

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wshadow"
#include <tiny_gltf.h>
#pragma GCC diagnostic pop

#include "base/box.h"
#include "field/mesh/surface.h"

namespace kelpie {

namespace {

/// glTF's colours at vertices are linear (section 3.7.2.1); the objects' are sRGB (IEC 61966-2-1).
float linear_of(uint8_t srgb) {
  const double v = srgb / 255.0;
  return float(v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4));
}

/// The vertices of an object, one for each normal that a place has.
struct SplitVertices {
  std::vector<Vec3> positions, normals, colours;
  std::vector<uint32_t> corners; ///< of all triangles

  explicit SplitVertices(const MeshObject& object) {
    constexpr double k_metres_per_mm = 0.001;
    Diagnostics unused; // of a manifold there is nothing to say
    const SurfaceMesh smooth = make_surface_mesh(object.mesh.positions, object.mesh.triangles, {}, object.name, unused);
    std::map<std::tuple<uint32_t, float, float, float>, uint32_t> known;
    for (size_t i = 0; i < smooth.triangles.size(); ++i)
      for (size_t k = 0; k < 3; ++k) {
        const uint32_t vertex = smooth.triangles[i][k];
        const Vec3& n = smooth.normals[i][k];
        const auto [at, is_new] = known.try_emplace({vertex, n.x, n.y, n.z}, static_cast<uint32_t>(positions.size()));
        corners.push_back(at->second);
        if (!is_new) continue;
        const auto& [r, g, b] = object.colours[vertex];
        positions.emplace_back(k_metres_per_mm * (smooth.origin + smooth.positions[vertex])), normals.push_back(n);
        colours.emplace_back(linear_of(r), linear_of(g), linear_of(b));
      }
  }
};

class GlbWriter {
public:
  GlbWriter() {
    model_.asset.version = "2.0", model_.asset.generator = "kelpie";
    model_.buffers.emplace_back();
    tinygltf::Material material;
    material.pbrMetallicRoughness.metallicFactor = 0, material.pbrMetallicRoughness.roughnessFactor = 0.5;
    model_.materials.push_back(std::move(material));
    model_.scenes.emplace_back();
    model_.defaultScene = 0;
  }

  void add(const MeshObject& object) {
    const SplitVertices split(object);
    Box3 box;
    for (const Vec3& p : split.positions) box.extend(p);
    tinygltf::Primitive primitive;
    primitive.mode = TINYGLTF_MODE_TRIANGLES, primitive.material = 0;
    const int position = add_vectors(split.positions);
    model_.accessors[size_t(position)].minValues = {box.lower.x, box.lower.y, box.lower.z};
    model_.accessors[size_t(position)].maxValues = {box.upper.x, box.upper.y, box.upper.z};
    primitive.attributes = {{"POSITION", position}, {"NORMAL", add_vectors(split.normals)}, {"COLOR_0", add_vectors(split.colours)}};
    primitive.indices = add_data(split.corners.data(), split.corners.size() * sizeof(uint32_t), split.corners.size(), TINYGLTF_TYPE_SCALAR,
                                 TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT, TINYGLTF_TARGET_ELEMENT_ARRAY_BUFFER);
    tinygltf::Mesh mesh;
    mesh.name = object.name, mesh.primitives.push_back(std::move(primitive));
    tinygltf::Node node;
    node.name = object.name, node.mesh = int(model_.meshes.size());
    model_.scenes[0].nodes.push_back(int(model_.nodes.size()));
    model_.meshes.push_back(std::move(mesh)), model_.nodes.push_back(std::move(node));
  }

  std::string bytes() const {
    std::ostringstream out;
    tinygltf::TinyGLTF().WriteGltfSceneToStream(&model_, out, false, true);
    return std::move(out).str();
  }

private:
  int add_vectors(const std::vector<Vec3>& v) {
    return add_data(v.data(), v.size() * sizeof(Vec3), v.size(), TINYGLTF_TYPE_VEC3, TINYGLTF_COMPONENT_TYPE_FLOAT,
                    TINYGLTF_TARGET_ARRAY_BUFFER);
  }

  /// Returns the accessor's number. All numbers are four bytes wide, so everything is aligned.
  int add_data(const void* data, size_t size, size_t count, int type, int component, int target) {
    std::vector<unsigned char>& buffer = model_.buffers[0].data;
    tinygltf::BufferView view;
    view.buffer = 0, view.byteOffset = buffer.size(), view.byteLength = size, view.target = target;
    buffer.resize(buffer.size() + size);
    std::memcpy(buffer.data() + view.byteOffset, data, size);
    tinygltf::Accessor accessor;
    accessor.bufferView = int(model_.bufferViews.size()), accessor.count = count, accessor.type = type, accessor.componentType = component;
    model_.bufferViews.push_back(std::move(view)), model_.accessors.push_back(std::move(accessor));
    return int(model_.accessors.size()) - 1;
  }

  tinygltf::Model model_;
};

} // namespace

std::string glb_bytes(std::span<const MeshObject> objects) {
  GlbWriter writer;
  for (const MeshObject& object : objects) writer.add(object);
  return writer.bytes();
}

} // namespace kelpie
