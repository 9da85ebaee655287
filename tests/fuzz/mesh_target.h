// What a file of a mesh may lead to: a mesh, or an Error that says what is wrong with it.
#pragma once

#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

#include "field/mesh/formats.h"
#include "field/mesh/surface.h"

namespace kelpie {

/// Reads the bytes by `read`, and as a file of that name is read and mended; both uses that meshes are put to.
template <class Read>
int try_mesh(const uint8_t* data, size_t size, const std::string& name, Read&& read) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  const auto attempt = [](auto&& action) {
    try {
      action();
    } catch (const Error& e) {
      if (e.status != ExitStatus::bad_data) std::abort();
    }
  };
  Diagnostics diagnostics;
  attempt([&] {
    const PolygonSoup soup = read(bytes, name, diagnostics);
    for (const uint32_t c : soup.corners)
      if (c >= soup.positions.size()) std::abort();
  });
  attempt([&] {
    const Mesh mesh = parse_mesh(bytes, name, diagnostics);
    for (const Vec3d& p : mesh.positions)
      if (!is_usable(p)) std::abort();
  });
  attempt([&] {
    std::vector<Vec3d> positions;
    std::vector<Triangle> triangles;
    read_triangles(bytes, name, diagnostics, positions, triangles);
    make_surface_mesh(std::move(positions), std::move(triangles), {}, name, diagnostics);
  });
  return 0;
}

} // namespace kelpie
