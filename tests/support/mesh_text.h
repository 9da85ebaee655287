// A tetrahedron, a sixth in volume, in each format of meshes that is text.
#pragma once

#include <string>

namespace kelpie {

inline const std::string k_obj_text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";

inline const std::string k_off_text = "OFF\n4 4 6\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n";

inline const std::string k_ply_text =
    "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nelement face 4\n"
    "property list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n";

inline std::string stl_facet(const std::string& a, const std::string& b, const std::string& c) {
  return "facet normal 0 0 0\nouter loop\nvertex " + a + "\nvertex " + b + "\nvertex " + c + "\nendloop\nendfacet\n";
}
inline const std::string k_stl_text = "solid a\n" + stl_facet("0 0 0", "0 1 0", "1 0 0") + stl_facet("0 0 0", "1 0 0", "0 0 1") +
                                      stl_facet("0 0 0", "0 0 1", "0 1 0") + stl_facet("1 0 0", "0 1 0", "0 0 1") + "endsolid a\n";

} // namespace kelpie
