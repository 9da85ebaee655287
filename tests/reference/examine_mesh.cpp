#include "tests/reference/examine_mesh.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/orientation.h>
#include <CGAL/Polygon_mesh_processing/polygon_soup_to_polygon_mesh.h>
#include <CGAL/Polygon_mesh_processing/self_intersections.h>
#include <CGAL/Surface_mesh.h>

namespace reference {

std::string faults_of_mesh(const std::vector<std::array<double, 3>>& positions, const std::vector<std::array<uint32_t, 3>>& triangles) {
  namespace pmp = CGAL::Polygon_mesh_processing;
  using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
  std::vector<Kernel::Point_3> points;
  for (const auto& p : positions) points.emplace_back(p[0], p[1], p[2]);
  std::vector<std::array<size_t, 3>> corners;
  for (const auto& t : triangles) corners.push_back({t[0], t[1], t[2]});
  if (!pmp::is_polygon_soup_a_polygon_mesh(corners)) return "not a manifold";
  CGAL::Surface_mesh<Kernel::Point_3> mesh;
  pmp::polygon_soup_to_polygon_mesh(points, corners, mesh);
  if (!CGAL::is_closed(mesh)) return "open";
  if (pmp::does_self_intersect(mesh)) return "meets itself";
  if (!pmp::does_bound_a_volume(mesh)) return "turned inside out";
  return "";
}

} // namespace reference
