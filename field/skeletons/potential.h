// From the distance to a skeleton's solid to its potential.
#pragma once

#include "field/potential/falloff.h"

namespace kelpie {

/// weight * falloff(d^2 / radius^2), d the Euclidean distance to `kind.solid()`; of a signed distance what it says. For double,
/// Interval and Dual.
template <class Kind, class Real>
Real potential(const Kind& kind, const Point3<Real>& p) {
  if constexpr (requires { kind.signed_distance(p); })
    return kind.potential(p);
  else {
    const Real d2 = squared_distance(kind.solid(), p);
    return double(kind.weight) * falloff(kind.falloff, d2 * (1 / square(double(kind.radius))));
  }
}

} // namespace kelpie
