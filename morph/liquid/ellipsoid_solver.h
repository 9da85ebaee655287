// The least-squares problem of fitting ellipsoidal blobs to a surface and its normals. Lengths are in units of the shape's diagonal.
#pragma once

#include <array>
#include <vector>

#include "morph/liquid/probe_grid.h"

namespace kelpie {

/// What is known of the shape at a point: that the surface is there (`normal`: and which way it faces), or not.
struct Probe {
  enum class Kind : uint8_t { surface, normal, outside, inside } kind = Kind::surface;
  std::array<Vec3d, 3> axes{}; ///< of a `normal`: two unit vectors across it, and itself
};

/// The distance (a share of the diagonal) and the sine of an angle that count as one unit of error.
inline constexpr double k_unit_distance = 0.001, k_unit_angle = 0.06;

class EllipsoidSolver {
public:
  /// What is known at each of the places.
  EllipsoidSolver(std::vector<Vec3d> places, std::vector<Probe> probes);
  EllipsoidSolver(const EllipsoidSolver&) = delete; // the grid refers to the places
  EllipsoidSolver& operator=(const EllipsoidSolver&) = delete;

  /// Moves, stretches and weighs the blobs so that {sum = 1} runs through the probes of the surface, across their normals, and the
  /// others are on their sides: some steps of Levenberg's and Marquardt's method, with the estimates of distances and angles as they are
  /// at the beginning of each. On one thread, in single precision where that does.
  void improve(std::vector<Ellipsoid>& blobs, int steps) const;

  /// The sum at each probe; its gradient only on the surface.
  std::vector<BlobValue> values(const std::vector<Ellipsoid>& blobs) const;

  const ProbeGrid& grid() const { return grid_; }

private:
  struct Scales;
  struct Jacobian;
  Scales scales(const std::vector<BlobValue>&) const;
  double slope_error(const Scales&, size_t probe, int axis, const Vec3d& gradient) const;
  double cost(const std::vector<BlobValue>&, const Scales&) const;
  Jacobian jacobian(const std::vector<Ellipsoid>&, const std::vector<BlobValue>&, const Scales&) const;

  std::vector<Vec3d> places_;
  std::vector<Probe> probes_;
  ProbeGrid grid_;
};

} // namespace kelpie
