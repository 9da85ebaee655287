#include "morph/liquid/medial_axis.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <new>

extern "C" {
#include <libqhull_r/qhull_ra.h>
}

namespace kelpie {

namespace {

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
    char command[] = "qhull d Qbb Qt Qz";
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

/// Points around all samples, several times as far away. Without them the samples of a flat side make one facet of the hull, which Qhull
/// takes minutes for if they are thousands.
void append_far_points(std::span<const SurfaceSample> samples, std::vector<double>& points) {
  Box3d box;
  for (const SurfaceSample& s : samples) box.extend(s.position);
  const double far = 4 * box.diagonal();
  for (int i = 0; i < 14; ++i) { // spread by the golden angle, no five of them on one ball
    const double height = 1 - (2 * i + 1) / 14.0, turn = 2.399963 * i, width = std::sqrt(1 - height * height);
    const Vec3d p = box.centre() + far * (1 + 0.02 * i) * Vec3d(width * std::cos(turn), height, width * std::sin(turn));
    points.insert(points.end(), {p.x, p.y, p.z});
  }
}

} // namespace

std::vector<Poles> find_poles(std::span<const SurfaceSample> samples, const TriangleTree& mesh) {
  std::vector<Poles> poles(samples.size());
  if (samples.size() < 5) return poles;
  std::vector<double> points;
  for (const SurfaceSample& s : samples) points.insert(points.end(), {s.position.x, s.position.y, s.position.z});
  append_far_points(samples, points);
  Qhull qhull;
  if (!qhull.triangulate(points)) return poles;
  struct Below {
    MedialSphere farthest, farthest_inside;
  };
  std::vector<Below> below(samples.size());
  const auto extend = [](MedialSphere& pole, const MedialSphere& ball) {
    if (ball.radius > pole.radius) pole = ball;
  };
  qhull.for_each_tetrahedron(points.size() / 3, [&](const size_t(&corner)[4]) {
    const auto at = [&](size_t i) { return Vec3d(points[3 * corner[i]], points[3 * corner[i] + 1], points[3 * corner[i] + 2]); };
    Vec3d centre;
    if (!circumcentre(at(0), at(1), at(2), at(3), centre)) return;
    const bool is_inside = mesh.winding(centre) > 0.5;
    for (const size_t i : corner) {
      if (i >= samples.size()) continue;
      const Vec3d to_centre = centre - samples[i].position;
      const MedialSphere ball{centre, glm::length(to_centre)};
      const bool is_below = glm::dot(to_centre, samples[i].normal) < 0;
      if (is_below) extend(below[i].farthest, ball);
      if (is_below && is_inside) extend(below[i].farthest_inside, ball);
      if (!is_below && !is_inside) extend(poles[i].outer, ball);
    }
  });
  // Where most cells reach through the wall, samples are farther apart than it is thick: what of them is inside must do.
  const auto is_whole = [](const Below& b) { return b.farthest_inside.radius > 0 && b.farthest_inside.radius == b.farthest.radius; };
  const auto whole = static_cast<size_t>(std::count_if(below.begin(), below.end(), is_whole));
  for (size_t i = 0; i < samples.size(); ++i)
    if (2 * whole < samples.size() || is_whole(below[i])) poles[i].inner = below[i].farthest_inside;
  return poles;
}

} // namespace kelpie
