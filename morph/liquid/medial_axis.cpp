#include "morph/liquid/medial_axis.h"

#include <cmath>
#include <cstdio>
#include <memory>
#include <new>

extern "C" {
#include <libqhull_r/qhull_ra.h>
}

namespace kelpie {

namespace {

constexpr double k_pi = 3.14159265358979323846;

/// Qhull's state, freed whatever happens.
class Qhull {
public:
  Qhull() { qh_zero(&state_, nullptr); }
  Qhull(const Qhull&) = delete;
  Qhull& operator=(const Qhull&) = delete;
  ~Qhull() {
    int current = 0, total = 0;
    state_.NOerrexit = True; // nothing to jump back to
    qh_freeqhull(&state_, !qh_ALL);
    qh_memfreeshort(&state_, &current, &total);
  }

  /// False where the points span no volume.
  bool triangulate(std::vector<double>& points) {
    char command[] = "qhull d Qbb Qt Qc Qz";
    // Qhull explains its failures on a stream; ours is that there are no poles.
    const std::unique_ptr<std::FILE, int (*)(std::FILE*)> sink(std::fopen("/dev/null", "w"), &std::fclose);
    const int failure = qh_new_qhull(&state_, 3, static_cast<int>(points.size() / 3), points.data(), False, command, nullptr, sink.get());
    if (failure == qh_ERRmem) throw std::bad_alloc();
    return failure == 0;
  }

  /// Calls `visit` with the indices of the four points of each Delaunay tetrahedron.
  template <class Visit>
  void for_each_tetrahedron(size_t points, Visit&& visit) {
    qhT* qh = &state_; // the name that Qhull's macros expect
    facetT* facet = nullptr;
    FORALLfacets {
      if (facet->upperdelaunay) continue;
      size_t corner[4], n = 0;
      vertexT *vertex = nullptr, **vertexp = nullptr;
      FOREACHvertex_(facet->vertices) {
        const int id = qh_pointid(qh, vertex->point);
        if (n < 4 && id >= 0 && static_cast<size_t>(id) < points) corner[n++] = static_cast<size_t>(id);
      }
      if (n == 4) visit(corner);
    }
  }

private:
  qhT state_;
};

/// The centre of the ball through four points; false where they lie (almost) in a plane.
bool circumcentre(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d, Vec3d& centre) {
  const Vec3d u = b - a, v = c - a, w = d - a;
  const double uu = glm::dot(u, u), vv = glm::dot(v, v), ww = glm::dot(w, w);
  const Vec3d vw = glm::cross(v, w);
  const double twice_det = 2 * glm::dot(u, vw);
  if (!(std::abs(twice_det) > 1e-9 * std::sqrt(uu * vv * ww))) return false;
  centre = a + (uu * vw + vv * glm::cross(w, u) + ww * glm::cross(u, v)) / twice_det;
  return true;
}

} // namespace

double winding_number(std::span<const SurfaceSample> samples, double area, const Vec3d& p) {
  // The solid angle of a small piece of area a at distance d along r: a (n . r) / d^3.
  double sum = 0;
  for (const SurfaceSample& s : samples) {
    const Vec3d r = s.position - p;
    const double squared = glm::dot(r, r) + 1e-30;
    sum += glm::dot(s.normal, r) / (squared * std::sqrt(squared));
  }
  return sum * area / (4 * k_pi * static_cast<double>(samples.size()));
}

std::vector<Poles> find_poles(std::span<const SurfaceSample> samples, double area) {
  std::vector<Poles> poles(samples.size());
  if (samples.size() < 5) return poles;
  std::vector<double> points;
  for (const SurfaceSample& s : samples) points.insert(points.end(), {s.position.x, s.position.y, s.position.z});
  Qhull qhull;
  if (!qhull.triangulate(points)) return poles;
  qhull.for_each_tetrahedron(samples.size(), [&](const size_t(&corner)[4]) {
    Vec3d centre;
    if (!circumcentre(samples[corner[0]].position, samples[corner[1]].position, samples[corner[2]].position, samples[corner[3]].position,
                      centre))
      return;
    for (const size_t i : corner) {
      const Vec3d to_centre = centre - samples[i].position;
      const double radius = glm::length(to_centre);
      MedialSphere& pole = glm::dot(to_centre, samples[i].normal) < 0 ? poles[i].inner : poles[i].outer;
      if (radius > pole.radius) pole = {centre, radius};
    }
  });
  for (Poles& p : poles) {
    if (p.inner.radius > 0 && winding_number(samples, area, p.inner.centre) < 0.5) p.inner = {};
    if (p.outer.radius > 0 && winding_number(samples, area, p.outer.centre) > 0.5) p.outer = {};
  }
  return poles;
}

} // namespace kelpie
