// Meshes without facets.
#pragma once

#include "field/mesh/mesh.h"

namespace kelpie {

/// The smooth surface of which a mesh's triangles are the facets: Loop's subdivision of it (by OpenSubdiv), until an average edge is no
/// longer than `edge` (file units), or three times. Where triangles meet at more than `crease` degrees an edge stays. A surface that is
/// smooth lies a little within its facets' corners: by about an eighth of an edge times the angle (radians) at which they meet.
/// A closed mesh stays closed. `file` names it in messages. Throws Error, bad_data, where its triangles do not fit together to a surface.
Mesh curved_mesh(const Mesh&, double crease, double edge, const std::string& file);

} // namespace kelpie
