// The least-squares problem of fitting blobs to a surface. Lengths are in units of the shape's diagonal.
#pragma once

#include <array>
#include <vector>

#include "morph/liquid/ellipsoid.h"

namespace kelpie {

/// The free parameters of a quartic blob: centre, log R, log W. Logarithms keep radius and weight positive.
using BlobParameters = std::array<double, 5>;

inline Vec3d centre_of(const BlobParameters& b) { return {b[0], b[1], b[2]}; }

/// The quartic blob's potential, and the sum of some.
BlobValue evaluate(const BlobParameters&, const Vec3d& p);
BlobValue evaluate(const std::vector<BlobParameters>&, const Vec3d& p);

/// What is known of the shape at a point.
struct Constraint {
  enum class Kind { surface, outside, inside } kind = Kind::surface;
  Vec3d position{0};
};

/// A blob in the fit: where it is and where it began.
struct FitBlob {
  BlobParameters now, start;
};

/// Moves blobs so that {sum = 1} runs through the surface constraints and the others are on their sides; a
/// few iterations of Levenberg–Marquardt with the distance estimate's denominators and the neighbours as they are
/// at the beginning: call it some times. On one
/// thread: Ceres adds up gradients in the order in which threads come.
void improve_blobs(std::vector<FitBlob>& blobs, const std::vector<Constraint>&);

} // namespace kelpie
