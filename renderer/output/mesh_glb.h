#pragma once

#include <span>
#include <string>

#include "renderer/mesh/mesh_object.h"

namespace kelpie {

/// A binary glTF 2.0 file: a node each, in metres as glTF wants it, with the colours of its vertices, and with normals that are
/// smooth but for creases of 30 degrees.
std::string glb_bytes(std::span<const MeshObject>);

} // namespace kelpie
