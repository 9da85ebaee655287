// Arc length along the axis of a deformation.
#pragma once

#include "base/spline.h"
#include "field/warps/axis_curve.h"

namespace kelpie {

/// A piece of a spline of degree 3 at most, as a step.
inline CubicStep<Vec3d> polynomial(const Spline<Vec3d>& curve, int piece) {
  CubicStep<Vec3d> out;
  const std::span<const Vec3d> c = curve.coefficients(piece);
  for (size_t i = 0; i < c.size(); ++i) out.a[i] = c[i];
  return out;
}

/// Arc length along a spline, by Gauss's rule.
class ArcLength {
public:
  explicit ArcLength(const Spline<Vec3d>& curve) : curve_(curve), before_{0} {
    for (int i = 0; i < cells(); ++i) before_.push_back(before_.back() + between(i, double(i), double(i + 1)));
  }
  double all() const { return before_.back(); }
  double to(double t) const {
    const double along = std::clamp(t, 0.0, 1.0) * cells();
    const int cell = std::min(static_cast<int>(along), cells() - 1);
    return before_[static_cast<size_t>(cell)] + between(cell, double(cell), along);
  }
  double t_at(double length) const {
    double low = 0, high = 1;
    for (int i = 0; i < 50; ++i) (to(0.5 * (low + high)) < length ? low : high) = 0.5 * (low + high);
    return 0.5 * (low + high);
  }

private:
  static constexpr int k_cells = 16;
  int cells() const { return k_cells * curve_.pieces(); }
  double between(int cell, double from, double to) const {
    constexpr std::array<double, 5> k_x{0, -0.5384693101056831, 0.5384693101056831, -0.9061798459386640, 0.9061798459386640};
    constexpr std::array<double, 5> k_w{0.5688888888888889, 0.4786286704993665, 0.4786286704993665, 0.2369268850561891, 0.2369268850561891};
    const CubicStep<Vec3d> c = polynomial(curve_, cell / k_cells);
    const double half = 0.5 * (to - from) / k_cells, middle = 0.5 * (from + to) / k_cells - cell / k_cells;
    double sum = 0;
    for (size_t i = 0; i < 5; ++i) sum += k_w[i] * glm::length(c.first(middle + half * k_x[i]));
    return sum * half;
  }

  const Spline<Vec3d>& curve_;
  std::vector<double> before_;
};

} // namespace kelpie
