#pragma once

#include <algorithm>
#include <cmath>

namespace kelpie {

/// A root of g between a and b, where g(a) = ga < 0 <= gb = g(b): a place where |g| is at most `tolerance`, or the nearest that numbers of
/// the type can tell. By regula falsi as modified by Anderson and Björck (1973): it takes a third of the steps of the Illinois rule, and
/// does not stall where g has a kink at the root itself, as an R-union of two equal fields has. Every fourth step halves the bracket if the
/// steps before it did not: beyond a crease g may rise a thousand times faster than before it, which makes regula falsi slow.
template <class Real, class Function>
Real bracketed_root(const Function& g, Real a, Real ga, Real b, Real gb, Real tolerance) {
  Real r = b, width = b - a;
  int side = 0; // which end the last place replaced
  for (int i = 0; i < 60; ++i) {
    r = a + (b - a) * (-ga / (gb - ga));
    if (i % 4 == 3) {
      if (b - a > Real(0.5) * width) r = Real(0.5) * (a + b);
      width = b - a;
    }
    if (!(r > a && r < b)) break;
    const Real gr = g(r);
    if (std::abs(gr) <= tolerance) break;
    if (gr < 0) {
      if (side < 0) gb *= gr > ga ? 1 - gr / ga : Real(0.5);
      a = r, ga = gr, side = -1;
    } else {
      if (side > 0) ga *= gr < gb ? 1 - gr / gb : Real(0.5);
      b = r, gb = gr, side = 1;
    }
  }
  return std::min(std::max(r, a), b);
}

} // namespace kelpie
