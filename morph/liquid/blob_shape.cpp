#include "morph/liquid/blob_shape.h"

#include <cmath>

namespace kelpie {

namespace {
constexpr float k_least_stiffness = 0.5f;
}

BlobShape shape_of(const Blob& b) {
  BlobShape s;
  s.stiffness = std::max(std::sqrt(std::abs(b.weight)) - 1, k_least_stiffness);
  s.sphere_radius = b.radius * std::sqrt(s.stiffness / (1 + s.stiffness));
  s.weight = b.weight / ((1 + s.stiffness) * (1 + s.stiffness));
  return s;
}

Blob to_blob(const BlobShape& s, Vec3 centre, Falloff falloff) {
  return {centre, s.sphere_radius * std::sqrt(1 + 1 / s.stiffness), s.weight * (1 + s.stiffness) * (1 + s.stiffness), falloff};
}

} // namespace kelpie
