// Affine maps.
#pragma once

#include "base/box.h"

namespace kelpie {

/// p -> linear p + offset, in double precision.
struct Affine {
  Mat3d linear{1.0};
  Vec3d offset{0.0};

  Vec3d operator()(const Vec3d& p) const { return linear * p + offset; }
  friend Affine operator*(const Affine& a, const Affine& b) { return {a.linear * b.linear, a.linear * b.offset + a.offset}; }
  friend Affine inverse(const Affine& a) {
    const Mat3d m = glm::inverse(a.linear);
    return {m, -(m * a.offset)};
  }
  template <class Real>
  Point3<Real> apply(const Point3<Real>& p) const {
    const Mat3d& m = linear;
    return {m[0][0] * p.x + m[1][0] * p.y + m[2][0] * p.z + Real(offset.x), m[0][1] * p.x + m[1][1] * p.y + m[2][1] * p.z + Real(offset.y),
            m[0][2] * p.x + m[1][2] * p.y + m[2][2] * p.z + Real(offset.z)};
  }
};

/// The box around the image of a box.
inline Box3d image_of(const Affine& f, const Box3d& box) {
  const Vec3d c = f(box.centre()), h = box.extent() * 0.5;
  Vec3d e(0);
  for (int i = 0; i < 3; ++i) e += glm::abs(f.linear[i]) * h[i];
  return {c - e, c + e};
}

} // namespace kelpie
