// From samples of a surface to ellipsoids: plates where a shape is a sheet, rods where it is a limb, flat blobs below the skin of a body.
#pragma once

#include <span>
#include <vector>

#include "morph/liquid/ellipsoid.h"
#include "morph/liquid/fit_samples.h"

namespace kelpie {

/// At most `count` ellipsoids, some times as large as the part of the surface of that area that each stands for, so that they make a smooth
/// sum; their weights are only a guess.
std::vector<Ellipsoid> start_ellipsoids(std::span<const FitSample>, double area, size_t count);

/// At most `most` balls for what those leave hollow, as deep as half of what one of `count` blobs is wide.
std::vector<Ellipsoid> fillers(const std::vector<Ellipsoid>&, std::span<const FitSample>, double area, size_t count, size_t most);

} // namespace kelpie
