// How bumpy a surface looks, whatever made it.
#pragma once

#include <optional>

#include "renderer/film/frame_image.h"

namespace kelpie {

/// Angles, in degrees.
struct Bumps {
  double median = 0;
  double p90 = 0; ///< nine tenths of the pixels have less
};

/// Of each pixel the angle between its normal and the normals around it, smoothed by a Gaussian of 3 pixels; without those within 5 pixels
/// of the silhouette. Creases wider than that hardly count. The image needs the channels N.X, N.Y, N.Z, which are 0 where there is nothing;
/// none where less than 50 pixels are left.
std::optional<Bumps> bumps_of(const FrameImage&);

} // namespace kelpie
