// From samples of a surface to ellipsoidal blobs.
#pragma once

#include <functional>

#include "morph/liquid/ellipsoid_solver.h"
#include "morph/liquid/fit_samples.h"

namespace kelpie {

class EllipsoidFitter {
public:
  EllipsoidFitter(std::vector<FitSample> samples, double area);
  std::vector<Ellipsoid> fit(size_t wanted, const std::function<void(double)>& progress) const;

private:
  void balance_weights(std::vector<Ellipsoid>&) const;
  void split_worst(std::vector<Ellipsoid>&, size_t wanted) const;
  void report(const char* what, const std::vector<Ellipsoid>&) const;

  std::vector<FitSample> samples_;
  double area_;
  EllipsoidSolver solver_;
};

} // namespace kelpie
