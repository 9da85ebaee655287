// From samples of a surface to ellipsoids: plates where a shape is a sheet, rods where it is a limb, flat blobs below the skin of a body.
#pragma once

#include <span>

#include "morph/liquid/ellipsoid.h"
#include "morph/liquid/fit_samples.h"

namespace kelpie {

/// About `count` ellipsoids, as large as what each stands for; what they weigh is only a guess.
std::vector<Ellipsoid> start_ellipsoids(std::span<const FitSample>, double area, size_t count);

/// Balls for what those leave hollow.
std::vector<Ellipsoid> fillers(const std::vector<Ellipsoid>&, std::span<const FitSample>, double least, size_t most);

} // namespace kelpie
