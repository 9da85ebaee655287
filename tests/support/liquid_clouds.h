// Small clouds for tests of liquids, and what their fields are.
#pragma once

#include <cmath>

#include "morph/liquid/interpolate.h"

namespace kelpie {

constexpr double k_pi = 3.14159265358979323846;
constexpr Correspondence k_all[] = {Correspondence::flow, Correspondence::transport, Correspondence::cellular};

inline double field(const BlobCloud& cloud, const Vec3d& p) {
  double sum = 0;
  for (const Blob& b : cloud) {
    const Vec3d d = p - Vec3d(b.centre);
    sum += b.weight * falloff(b.falloff, glm::dot(d, d) / (double(b.radius) * b.radius));
  }
  return sum;
}

/// Blobs in a row, and a ring of smaller ones: different counts, sizes and places.
inline BlobCloud row() {
  BlobCloud c;
  for (int i = 0; i < 7; ++i) c.push_back({Vec3(0.3f * i, 0, 0), 0.5f, 2.f, Falloff::quartic});
  return c;
}
inline BlobCloud ring() {
  BlobCloud c;
  for (int i = 0; i < 20; ++i) {
    const float a = static_cast<float>(2 * k_pi * i / 20);
    c.push_back({Vec3(5 + std::cos(a), std::sin(a), 0.1f), 0.3f + 0.1f * std::cos(a), 1.5f, Falloff::quartic});
  }
  return c;
}

inline BlobCloud at(const LiquidMorph& morph, float progress) {
  BlobCloud c;
  morph.append_blobs(progress, c);
  return c;
}

inline bool same(const BlobCloud& a, const BlobCloud& b) {
  if (a.size() != b.size()) return false;
  for (size_t i = 0; i < a.size(); ++i)
    if (a[i].centre != b[i].centre || a[i].radius != b[i].radius || a[i].weight != b[i].weight) return false;
  return true;
}

} // namespace kelpie
