// The paper's parameters of a blob: its sphere, its stiffness, its weight.
#pragma once

#include "field/potential/blob.h"

namespace kelpie {

/// A blob as liquid morphing sees it (Jin et al. 2005, eq. 3): w (1+B)^2 (1 - r^2/R^2)^2 with
/// R^2 = e^2 (1 + 1/B). With w = 1 the blob alone has its surface exactly on the sphere of radius e.
struct BlobShape {
  float sphere_radius = 1; ///< e, in scene units
  float stiffness = 1;     ///< B
  float weight = 1;        ///< w
};

/// A blob of a cloud states R and W = w (1+B)^2 only: two numbers for three. We take w = 1, so that e
/// is where the blob's own surface lies, and B = sqrt(W) - 1, but not below 1/2: under that e shrinks
/// to nothing, and a blob that takes part in the surface only by its sum with others is a light one
/// of ordinary stiffness.
BlobShape shape_of(const Blob&);

/// The inverse of `shape_of`: the radius of influence and the weight of a scene's blob.
Blob to_blob(const BlobShape&, Vec3 centre, Falloff);

} // namespace kelpie
