// Files of meshes.
#pragma once

#include <span>
#include <string>

#include "renderer/mesh/mesh_object.h"

namespace kelpie {

enum class MeshFormat {
  ply,     ///< binary; all objects are one list of vertices and triangles, with colours
  stl,     ///< binary; all objects are one list of triangles
  obj,     ///< text; an object each
  threemf, ///< an object each, with colours
  glb,     ///< an object each, with colours, in metres
};

/// By the name of a file. Throws Error, usage, for a name that ends otherwise.
MeshFormat mesh_format_of(const std::string& path);

/// The whole file; in millimetres, unless the format has a unit of its own.
std::string mesh_file_bytes(MeshFormat, std::span<const MeshObject>);

} // namespace kelpie
