// What CGAL says of a triangle mesh.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace reference {

/// What is wrong with it as the border of a solid: "not a manifold", "open", "turned inside out", "meets itself"; empty: nothing. Decided
/// with exact arithmetic.
std::string faults_of_mesh(const std::vector<std::array<double, 3>>& positions, const std::vector<std::array<uint32_t, 3>>& triangles);

} // namespace reference
