// Writes the meshes of the demonstration, torus.obj and double_torus.obj: closed, manifold, outward.
//   make_demo_meshes FOLDER
//
// Both are level surfaces, polygonised by surface nets: one vertex in each grid cell that the
// surface passes through, one quadrilateral for each grid edge that it crosses, so the mesh is closed by
// construction. Vertices are then pulled onto the surface along the gradient.
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <stdexcept>
#include <vector>

#include "base/vec.h"

namespace {

using kelpie::Vec3d;

/// Positive inside.
using Function = std::function<double(const Vec3d&)>;

/// A ring that stands upright, its axis along z, its middle at x = `centre`, 1 in radius and as thick as `tube` says.
double ring(const Vec3d& p, double centre, double tube) { return tube - std::hypot(std::hypot(p.x - centre, p.y) - 1, p.z); }

double torus(const Vec3d& p) { return ring(p, 0, 0.4); }

/// Two rings that grow together where they meet.
double double_torus(const Vec3d& p) {
  constexpr double k_blend = 0.3;
  const double a = ring(p, -1.1, 0.34), b = ring(p, 1.1, 0.34);
  const double h = std::max(k_blend - std::abs(a - b), 0.0) / k_blend;
  return std::max(a, b) + h * h * k_blend / 4; // the smooth maximum
}

class SurfaceNet {
public:
  SurfaceNet(const Function& f, double half_size, int cells) : f_(f), lower_(-half_size), step_(2 * half_size / cells), n_(cells) {
    corner_is_inside_.resize(size_t(n_ + 1) * (n_ + 1) * (n_ + 1));
    vertex_of_cell_.assign(size_t(n_) * n_ * n_, -1);
    for (int z = 0; z <= n_; ++z)
      for (int y = 0; y <= n_; ++y)
        for (int x = 0; x <= n_; ++x) corner_is_inside_[corner(x, y, z)] = f_(at(x, y, z)) > 0;
    make_vertices();
    for (int axis = 0; axis < 3; ++axis) make_faces(axis);
  }

  void write(const std::string& path) const {
    std::FILE* file = std::fopen(path.c_str(), "w");
    if (!file) throw std::runtime_error(path + ": cannot write");
    for (const Vec3d& p : positions_) std::fprintf(file, "v %.6f %.6f %.6f\n", p.x, p.y, p.z);
    for (const auto& q : quads_) std::fprintf(file, "f %d %d %d %d\n", q[0] + 1, q[1] + 1, q[2] + 1, q[3] + 1);
    const bool is_good = std::fflush(file) == 0 && !std::ferror(file);
    if (std::fclose(file) != 0 || !is_good) throw std::runtime_error(path + ": cannot write");
  }

private:
  Vec3d at(double x, double y, double z) const { return Vec3d(lower_) + step_ * Vec3d(x, y, z); }
  size_t corner(int x, int y, int z) const { return (size_t(z) * (n_ + 1) + y) * (n_ + 1) + x; }
  int& vertex(int x, int y, int z) { return vertex_of_cell_[(size_t(z) * n_ + y) * n_ + x]; }

  void make_vertices() {
    for (int z = 0; z < n_; ++z)
      for (int y = 0; y < n_; ++y)
        for (int x = 0; x < n_; ++x) {
          int inside = 0;
          for (int c = 0; c < 8; ++c) inside += corner_is_inside_[corner(x + (c & 1), y + (c >> 1 & 1), z + (c >> 2))];
          if (inside == 0 || inside == 8) continue;
          vertex(x, y, z) = int(positions_.size());
          positions_.push_back(pulled_to_surface(at(x + 0.5, y + 0.5, z + 0.5)));
        }
  }

  Vec3d pulled_to_surface(Vec3d p) const {
    const double h = 1e-4 * step_;
    for (int i = 0; i < 20; ++i) {
      Vec3d g;
      for (int k = 0; k < 3; ++k) {
        Vec3d d(0);
        d[k] = h;
        g[k] = (f_(p + d) - f_(p - d)) / (2 * h);
      }
      const Vec3d move = -f_(p) * g / std::max(glm::dot(g, g), 1e-12);
      p += move * std::min(1.0, 0.5 * step_ / std::max(glm::length(move), 1e-12));
    }
    return p;
  }

  /// The quadrilaterals around the crossed grid edges along `axis`, seen counter-clockwise from outside.
  void make_faces(int axis) {
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    glm::ivec3 p;
    for (p.z = 1; p.z < n_; ++p.z)
      for (p.y = 1; p.y < n_; ++p.y)
        for (p.x = 1; p.x < n_; ++p.x) {
          glm::ivec3 next = p;
          ++next[axis];
          const bool here = corner_is_inside_[corner(p.x, p.y, p.z)], there = corner_is_inside_[corner(next.x, next.y, next.z)];
          if (here == there) continue;
          std::array<int, 4> quad;
          for (int k = 0; k < 4; ++k) {
            glm::ivec3 cell = p;
            if (k == 0 || k == 3) --cell[u];
            if (k < 2) --cell[v];
            quad[k] = vertex(cell.x, cell.y, cell.z);
          }
          if (!here) std::swap(quad[1], quad[3]);
          quads_.push_back(quad);
        }
  }

  const Function& f_;
  double lower_, step_;
  int n_;
  std::vector<char> corner_is_inside_;
  std::vector<int> vertex_of_cell_;
  std::vector<Vec3d> positions_;
  std::vector<std::array<int, 4>> quads_;
};

} // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: make_demo_meshes FOLDER\n");
    return 2;
  }
  try {
    const std::filesystem::path folder(argv[1]);
    std::filesystem::create_directories(folder);
    SurfaceNet(torus, 1.6, 64).write((folder / "torus.obj").string());
    SurfaceNet(double_torus, 2.6, 96).write((folder / "double_torus.obj").string());
  } catch (const std::exception& e) {
    std::fprintf(stderr, "error: %s\n", e.what());
    return 74;
  }
  return 0;
}
