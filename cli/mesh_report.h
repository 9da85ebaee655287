// What `kelpie mesh` says of what it has made.
#pragma once

#include <span>
#include <string>

#include "renderer/mesh/mesh_frame.h"
#include "renderer/mesh/survey.h"

namespace kelpie {

/// A line an object.
std::string mesh_summary(std::span<const MeshObject>, std::span<const Survey>);
/// The same as JSON; lengths in millimetres.
std::string mesh_json(const MeshedFrame&, std::span<const Survey>);

} // namespace kelpie
