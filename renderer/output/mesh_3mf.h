#pragma once

#include <span>
#include <string>

#include "renderer/mesh/mesh_object.h"

namespace kelpie {

/// A 3MF file (3MF Core Specification 1.3, Materials and Properties Extension 1.2): an object each, in millimetres, the colours of its
/// vertices as a colour group. The same bytes for the same objects. (lib3mf is not used: Debian's fails tests of its own.)
std::string threemf_bytes(std::span<const MeshObject>);

} // namespace kelpie
