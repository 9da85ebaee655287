// Files of meshes, read back by others.
#include "renderer/output/mesh_file.h"

#include <cmath>
#include <regex>

#include <gtest/gtest.h>
#include <zip.h>

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wshadow"
#include <tiny_gltf.h>
#pragma GCC diagnostic pop

namespace kelpie {
namespace {

/// Two tetrahedra, red and blue but for a corner, with numbers that need all digits of a float.
std::vector<MeshObject> two_objects() {
  MeshObject a;
  a.name = "a <&> \"b\"";
  a.mesh.positions = {{0, 0, 0}, {float(1 / 3.0), 0, 0}, {0, 200.0625, 0}, {0, 0, 1e-3f}};
  a.mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  a.colours = {{255, 0, 0}, {255, 0, 0}, {255, 0, 0}, {0, 128, 0}};
  MeshObject b = a;
  b.name = "b";
  for (Vec3d& p : b.mesh.positions) p.x += 300;
  for (auto& colour : b.colours) colour = {0, 0, 255};
  return {a, b};
}

void expect_all_triangles(const std::string& bytes, const std::string& name) {
  Diagnostics diagnostics;
  const Mesh read = parse_mesh(bytes, name, diagnostics);
  EXPECT_TRUE(is_closed(read));
  double volume = 0;
  size_t triangles = 0;
  for (const MeshObject& o : two_objects()) volume += signed_volume(o.mesh), triangles += o.mesh.triangles.size();
  EXPECT_EQ(read.triangles.size(), triangles);
  EXPECT_NEAR(signed_volume(read), volume, 1e-6);
}

TEST(MeshFile, PlyStlAndObj) {
  const std::vector<MeshObject> objects = two_objects();
  expect_all_triangles(mesh_file_bytes(MeshFormat::ply, objects), "a.ply");
  expect_all_triangles(mesh_file_bytes(MeshFormat::stl, objects), "a.stl");
  expect_all_triangles(mesh_file_bytes(MeshFormat::obj, objects), "a.obj");
}

std::string unzipped(std::string bytes, const char* name) {
  zip_source_t* source = zip_source_buffer_create(bytes.data(), bytes.size(), 0, nullptr);
  zip_t* archive = zip_open_from_source(source, ZIP_RDONLY, nullptr);
  zip_stat_t stat;
  if (!archive || zip_stat(archive, name, 0, &stat) != 0) return "";
  std::string text(stat.size, '\0');
  zip_file_t* file = zip_fopen(archive, name, 0);
  EXPECT_EQ(zip_fread(file, text.data(), text.size()), zip_int64_t(text.size()));
  zip_fclose(file), zip_discard(archive);
  return text;
}

std::vector<std::smatch> matches(const std::string& text, const char* pattern) {
  const std::regex regex(pattern);
  return {std::sregex_iterator(text.begin(), text.end(), regex), std::sregex_iterator()};
}

TEST(MeshFile, ThreeMf) {
  const std::vector<MeshObject> objects = two_objects();
  const std::string bytes = mesh_file_bytes(MeshFormat::threemf, objects);
  EXPECT_EQ(bytes, mesh_file_bytes(MeshFormat::threemf, objects)) << "no time of day";
  EXPECT_NE(unzipped(bytes, "[Content_Types].xml").find("3dmanufacturing-3dmodel+xml"), std::string::npos);
  EXPECT_NE(unzipped(bytes, "_rels/.rels").find("\"/3D/3dmodel.model\""), std::string::npos);
  const std::string model = unzipped(bytes, "3D/3dmodel.model");
  EXPECT_NE(model.find("unit=\"millimeter\""), std::string::npos);
  EXPECT_NE(model.find("name=\"a &lt;&amp;> &quot;b&quot;\""), std::string::npos);
  EXPECT_EQ(matches(model, "<item objectid=").size(), 2u);
  const auto vertices = matches(model, "<vertex x=\"([^\"]*)\" y=\"([^\"]*)\" z=\"([^\"]*)\"/>");
  const auto triangles = matches(model, "<triangle v1=\"(.*)\" v2=\"(.*)\" v3=\"(.*)\" pid=\"(.*)\" p1=\"(.*)\" p2=\"(.*)\" p3=\"(.*)\"/>");
  const auto colours = matches(model, "<m:color color=\"(#.{6})\"/>");
  ASSERT_EQ(vertices.size(), 8u);
  ASSERT_EQ(triangles.size(), 8u);
  ASSERT_EQ(colours.size(), 3u);
  EXPECT_EQ(colours[0][1], "#FF0000");
  EXPECT_EQ(colours[1][1], "#008000");
  EXPECT_EQ(colours[2][1], "#0000FF");
  for (size_t i = 0; i < 8; ++i) {
    const MeshObject& object = objects[i / 4];
    for (size_t k = 0; k < 3; ++k) {
      EXPECT_EQ(std::stof(vertices[i][k + 1]), float(object.mesh.positions[i % 4][int(k)]));
      EXPECT_EQ(std::stoul(triangles[i][k + 1]), object.mesh.triangles[i % 4][k]);
      EXPECT_EQ(std::stoul(triangles[i][k + 5]), i < 4 && object.mesh.triangles[i % 4][k] == 3 ? 1u : 0u) << "in its group";
    }
  }
}

TEST(MeshFile, Glb) {
  const std::vector<MeshObject> objects = two_objects();
  const std::string bytes = mesh_file_bytes(MeshFormat::glb, objects);
  tinygltf::Model model;
  std::string problems, warnings;
  ASSERT_TRUE(tinygltf::TinyGLTF().LoadBinaryFromMemory(&model, &problems, &warnings, reinterpret_cast<const unsigned char*>(bytes.data()),
                                                        static_cast<unsigned>(bytes.size())))
      << problems;
  EXPECT_EQ(warnings, "");
  ASSERT_EQ(model.meshes.size(), 2u);
  EXPECT_EQ(model.nodes[1].name, "b");
  const auto floats = [&](const char* attribute) {
    const tinygltf::Accessor& a = model.accessors[size_t(model.meshes[0].primitives[0].attributes.at(attribute))];
    std::vector<Vec3> out(a.count);
    std::memcpy(static_cast<void*>(out.data()), model.buffers[0].data.data() + model.bufferViews[size_t(a.bufferView)].byteOffset,
                out.size() * sizeof(Vec3));
    return out;
  };
  const std::vector<Vec3> positions = floats("POSITION"), normals = floats("NORMAL"), colours = floats("COLOR_0");
  ASSERT_EQ(positions.size(), 12u) << "three normals a corner";
  float highest = 0;
  for (size_t i = 0; i < 12; ++i) {
    highest = std::max(highest, positions[i].y);
    EXPECT_NEAR(glm::length(normals[i]), 1, 1e-5);
    const bool is_green = positions[i].z > 0;
    EXPECT_NEAR(colours[i].y, is_green ? 0.21586 : 0, 1e-4) << "128 is linear 0.216";
    EXPECT_NEAR(colours[i].x, is_green ? 0 : 1, 1e-6);
  }
  EXPECT_FLOAT_EQ(highest, 0.2000625f) << "metres";
}

} // namespace
} // namespace kelpie
