// From samples of a surface to ellipsoidal blobs.
#pragma once

#include <functional>

#include "morph/liquid/ellipsoid_solver.h"
#include "morph/liquid/fit_samples.h"

namespace kelpie {

/// Fits ellipsoidal blobs to evenly spread surface samples (in units of the shape's diagonal).
class EllipsoidFitter {
public:
  /// About k_samples_per_blob samples of the surface, of that area, per blob determine its ten unknowns: each tells a place and a normal.
  EllipsoidFitter(std::vector<FitSample> samples, double area);
  static constexpr size_t k_samples_per_blob = 18;

  /// At most `wanted` blobs. `progress` is called with the share that is done.
  std::vector<Ellipsoid> fit(size_t wanted, const std::function<void(double)>& progress) const;

private:
  void balance_weights(std::vector<Ellipsoid>&) const;
  void split_worst(std::vector<Ellipsoid>&, size_t wanted) const;
  std::vector<double> errors(const std::vector<BlobValue>&) const;

  std::vector<FitSample> samples_; ///< the solver's first probes
  double area_;
  EllipsoidSolver solver_;
};

} // namespace kelpie
