#include "morph/liquid/match.h"

#include <cmath>

#include "morph/liquid/blob_shape.h"

namespace kelpie {

namespace {

/// A blob in the canonical frame: its sphere.
struct Sphere {
  Vec3d centre{0};
  double radius = 0;
};

/// The cloud's spheres with their common centre of volume in the origin and a mean square distance
/// from it (that of all their points) of 1.
std::vector<Sphere> canonical(const BlobCloud& cloud) {
  std::vector<Sphere> spheres;
  Vec3d sum(0);
  double volume = 0, spread = 0;
  for (const Blob& b : cloud) {
    const double e = shape_of(b).sphere_radius, v = e * e * e;
    spheres.push_back({Vec3d(b.centre), e});
    sum += v * Vec3d(b.centre), volume += v;
  }
  const Vec3d centre = sum / volume;
  for (Sphere& s : spheres) {
    s.centre -= centre;
    spread += s.radius * s.radius * s.radius * (glm::dot(s.centre, s.centre) + 0.6 * s.radius * s.radius);
  }
  const double scale = 1 / std::sqrt(spread / volume);
  for (Sphere& s : spheres) s.centre *= scale, s.radius *= scale;
  return spheres;
}

/// The distance of spheres: methods.md section 1, eq. 5, alpha = beta = 1.
double sphere_distance(const Sphere& a, const Sphere& b) {
  const Vec3d d = a.centre - b.centre;
  return glm::dot(d, d) + std::abs(a.radius - b.radius);
}

size_t nearest(const Sphere& s, const std::vector<Sphere>& others) {
  size_t best = 0;
  for (size_t j = 1; j < others.size(); ++j)
    if (sphere_distance(s, others[j]) < sphere_distance(s, others[best])) best = j;
  return best;
}

} // namespace

std::vector<Link> match_cellular(const BlobCloud& from, const BlobCloud& to) {
  const std::vector<Sphere> a = canonical(from), b = canonical(to);
  std::vector<std::vector<char>> linked(a.size(), std::vector<char>(b.size(), 0));
  for (size_t i = 0; i < a.size(); ++i) linked[i][nearest(a[i], b)] = 1;
  for (size_t j = 0; j < b.size(); ++j) linked[nearest(b[j], a)][j] = 1;
  std::vector<unsigned> from_count(a.size(), 0), to_count(b.size(), 0);
  std::vector<Link> links;
  for (unsigned i = 0; i < a.size(); ++i)
    for (unsigned j = 0; j < b.size(); ++j)
      if (linked[i][j]) links.push_back({i, j, 1, 1}), ++from_count[i], ++to_count[j];
  for (Link& l : links) l.from_share = 1.f / from_count[l.from], l.to_share = 1.f / to_count[l.to];
  return links;
}

} // namespace kelpie
