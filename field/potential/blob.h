// A blob: the point skeleton in the form in which clouds hold it by the hundred thousand.
#pragma once

#include <vector>

#include "base/box.h"
#include "field/potential/falloff.h"

namespace kelpie {

/// The potential weight * falloff(|p - centre|^2 / radius^2). `radius` is that of influence, in scene units.
struct Blob {
  Vec3 centre{0};
  float radius = 1;
  float weight = 1;
  Falloff falloff = Falloff::quartic;
};

using BlobCloud = std::vector<Blob>;

/// The box outside which the blob is 0.
inline Box3 support(const Blob& b) { return {b.centre - Vec3(b.radius), b.centre + Vec3(b.radius)}; }

} // namespace kelpie
