#pragma once

#include <algorithm>
#include <cmath>

namespace kelpie {

/// A place between a and b where g, with g(a) = ga < 0 <= gb = g(b), is within `tolerance` of 0: regula falsi with the
/// Illinois rule.
template <class Function>
float bracketed_root(const Function& g, float a, float ga, float b, float gb, float tolerance) {
  float r = b;
  for (int i = 0; i < 20; ++i) {
    r = a + (b - a) * (-ga / (gb - ga));
    if (!(r > a && r < b)) break;
    const float gr = g(r);
    if (std::abs(gr) <= tolerance) break;
    if (gr < 0)
      a = r, ga = gr, gb *= i > 0 ? 0.5f : 1.f;
    else
      b = r, gb = gr, ga *= i > 0 ? 0.5f : 1.f;
  }
  return std::min(std::max(r, a), b);
}

} // namespace kelpie
