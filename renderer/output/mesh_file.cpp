#include "renderer/output/mesh_file.h"

#include <algorithm>
#include <cctype>
#include <cstring>
#include <filesystem>

#include <fmt/format.h>

#include "base/error.h"
#include "renderer/output/mesh_3mf.h"
#include "renderer/output/mesh_glb.h"

namespace kelpie {

namespace {

/// Appends numbers as they lie in memory, as both binary formats want them on this machine.
template <class... T>
void append(std::string& out, const T&... values) {
  static_assert((std::is_trivially_copyable_v<T> && ...));
  (out.append(reinterpret_cast<const char*>(&values), sizeof values), ...);
}

void append_floats(std::string& out, const Vec3d& v) { append(out, float(v.x), float(v.y), float(v.z)); }

std::string ply_bytes(std::span<const MeshObject> objects) {
  size_t vertices = 0, triangles = 0;
  for (const MeshObject& o : objects) vertices += o.mesh.positions.size(), triangles += o.mesh.triangles.size();
  std::string out = fmt::format("ply\nformat binary_little_endian 1.0\ncomment kelpie, millimetres\nelement vertex {}\n"
                                "property float x\nproperty float y\nproperty float z\n"
                                "property uchar red\nproperty uchar green\nproperty uchar blue\n"
                                "element face {}\nproperty list uchar int vertex_indices\nend_header\n",
                                vertices, triangles);
  for (const MeshObject& o : objects)
    for (size_t i = 0; i < o.mesh.positions.size(); ++i) append_floats(out, o.mesh.positions[i]), append(out, o.colours[i]);
  uint32_t first = 0;
  for (const MeshObject& o : objects) {
    for (const Triangle& t : o.mesh.triangles) append(out, uint8_t(3), first + t[0], first + t[1], first + t[2]);
    first += static_cast<uint32_t>(o.mesh.positions.size());
  }
  return out;
}

std::string stl_bytes(std::span<const MeshObject> objects) {
  constexpr size_t k_header = 80;
  std::string out = "kelpie, millimetres"; // no name may begin with `solid`, as text does
  out.resize(k_header, ' ');
  uint32_t triangles = 0;
  for (const MeshObject& o : objects) triangles += static_cast<uint32_t>(o.mesh.triangles.size());
  append(out, triangles);
  for (const MeshObject& o : objects)
    for (const Triangle& t : o.mesh.triangles) {
      const Vec3d &a = o.mesh.positions[t[0]], &b = o.mesh.positions[t[1]], &c = o.mesh.positions[t[2]];
      append_floats(out, glm::normalize(glm::cross(b - a, c - a)));
      append_floats(out, a), append_floats(out, b), append_floats(out, c);
      append(out, uint16_t(0));
    }
  return out;
}

std::string obj_bytes(std::span<const MeshObject> objects) {
  std::string out = "# kelpie, millimetres\n";
  uint32_t first = 1;
  for (const MeshObject& o : objects) {
    fmt::format_to(std::back_inserter(out), "o {}\n", o.name);
    for (const Vec3d& p : o.mesh.positions) fmt::format_to(std::back_inserter(out), "v {} {} {}\n", float(p.x), float(p.y), float(p.z));
    for (const Triangle& t : o.mesh.triangles)
      fmt::format_to(std::back_inserter(out), "f {} {} {}\n", first + t[0], first + t[1], first + t[2]);
    first += static_cast<uint32_t>(o.mesh.positions.size());
  }
  return out;
}

} // namespace

MeshFormat mesh_format_of(const std::string& path) {
  std::string ending = std::filesystem::path(path).extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (ending == ".ply") return MeshFormat::ply;
  if (ending == ".stl") return MeshFormat::stl;
  if (ending == ".obj") return MeshFormat::obj;
  if (ending == ".3mf") return MeshFormat::threemf;
  if (ending == ".glb") return MeshFormat::glb;
  throw Error(ExitStatus::usage, fmt::format("\"{}\" must end in .ply, .stl, .obj, .3mf or .glb: that says the format", path));
}

std::string mesh_file_bytes(MeshFormat format, std::span<const MeshObject> objects) {
  switch (format) {
  case MeshFormat::ply: return ply_bytes(objects);
  case MeshFormat::stl: return stl_bytes(objects);
  case MeshFormat::obj: return obj_bytes(objects);
  case MeshFormat::threemf: return threemf_bytes(objects);
  case MeshFormat::glb: return glb_bytes(objects);
  }
  return {};
}

} // namespace kelpie
