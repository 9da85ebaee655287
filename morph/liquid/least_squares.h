// The least-squares problem of fitting blobs to a surface. Lengths are in units of the shape's diagonal.
#pragma once

#include <array>
#include <vector>

#include "base/vec.h"

namespace kelpie {

/// The free parameters of a quartic blob: centre, log R, log W. Logarithms keep radius and weight positive.
using BlobParameters = std::array<double, 5>;

inline Vec3d centre_of(const BlobParameters& b) { return {b[0], b[1], b[2]}; }

/// W q^2, q = 1 - |p - c|^2/R^2, or a sum of such.
struct BlobValue {
  double value = 0;
  Vec3d gradient{0}; ///< with respect to p
};
BlobValue evaluate(const BlobParameters&, const Vec3d& p);
BlobValue evaluate(const std::vector<BlobParameters>&, const Vec3d& p);

/// What is known of the shape at a point.
struct Constraint {
  enum class Kind { surface, outside, inside } kind = Kind::surface;
  Vec3d position{0};
};

/// Distance of a point with that value from {f = 1}, to first order; positive inside. Where the field is flat the
/// gradient says nothing, so it counts as at least that of a ball of 0.4 diagonals.
double distance_estimate(const BlobValue&);

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
