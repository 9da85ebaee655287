// The least-squares problem of fitting ellipsoidal blobs to a surface and its normals. Lengths are in units of the shape's diagonal.
#pragma once

#include <array>
#include <vector>

#include "morph/liquid/probe_grid.h"

namespace kelpie {

/// What is known of the shape at a point.
struct Probe {
  enum class Kind : uint8_t { surface, normal, outside, inside } kind = Kind::surface; ///< `normal`: of the surface, and its normal is known
  std::array<Vec3d, 3> axes{}; ///< unit vectors: two across the normal, and the normal
};

/// The distance (a share of the diagonal) and the angle's sine that count as one unit of error.
inline constexpr double k_unit_distance = 0.001, k_unit_angle = 0.06;

/// Distance of a point with that value from {f = 1}, to first order; positive inside. Where the field is flat the
/// gradient says nothing, so it counts as at least that of a ball of 0.4 diagonals.
double distance_estimate(const BlobValue&);

class EllipsoidSolver {
public:
  EllipsoidSolver(std::vector<Vec3d> places, std::vector<Probe> probes);

  /// Moves, stretches and weighs the blobs so that {sum = 1} runs through the surface's probes across their normals and the others are on
  /// their sides: some steps of Levenberg and Marquardt's method.
  void improve(std::vector<Ellipsoid>& blobs, int steps) const;

  /// The sum at each probe.
  std::vector<BlobValue> values(const std::vector<Ellipsoid>& blobs) const;

  const ProbeGrid& grid() const { return grid_; }
  const std::vector<Vec3d>& places() const { return places_; }
  const std::vector<Probe>& probes() const { return probes_; }

private:
  struct Scales;
  Scales scales(const std::vector<BlobValue>&) const;
  int rows_of(const Scales&, size_t probe) const;
  double slope_error(const Scales&, size_t probe, int axis, const Vec3d& gradient) const;
  double cost(const std::vector<BlobValue>&, const Scales&) const;

  std::vector<Vec3d> places_;
  std::vector<Probe> probes_;
  ProbeGrid grid_;
};

} // namespace kelpie
