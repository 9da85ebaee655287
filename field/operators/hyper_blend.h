#pragma once

#include <cmath>

#include "field/operators/operator.h"

namespace kelpie {

template <class Mode>
struct HyperBlend {
  static constexpr std::string_view k_name = "hyper_blend";
  static constexpr std::string_view k_doc = R"(Between a blend and a union: how far its children flow together is one number.

    f = (f_A^n + f_B^n + …)^(1/n),   negative values count as 0

n = 1 is the `blend`; as n grows it becomes the `union`; below 1 the children bulge where they meet, and there the
surface may have creases. Computed as m (sum (f_i/m)^n)^(1/n) with m the largest, so that no n overflows.
With n < 1 the slope has no bound where a child ends: pictures take longer. Source: methods.md section 2.)";

  Value<Mode, float> n{2.f};
  typename Mode::Children children;

  static constexpr auto parameters() {
    return std::tuple{
        parameter("n", &HyperBlend::n, "1: blend; large: union").above(0),
        parameter("children", &HyperBlend::children, "the fields to join").required(),
    };
  }

  static constexpr Lone k_lone = Lone::above_0;

  double combine(std::span<const double> f, double /*threshold*/, Demand /*mine*/) const {
    return total(f.size(), [&](size_t i) { return f[i]; });
  }
  /// It rises with every operand.
  Interval combine(std::span<const Interval> f, double /*threshold*/, Demand /*mine*/) const {
    return {total(f.size(), [&](size_t i) { return f[i].lo; }), total(f.size(), [&](size_t i) { return f[i].hi; })};
  }
  /// By an operand its slope is (f_i / f)^(n-1).
  template <class T, int N>
  Dual<T, N> combine(std::span<const Dual<T, N>> f, double /*threshold*/, Demand /*mine*/) const {
    std::vector<T> values;
    for (const Dual<T, N>& x : f) values.push_back(x.value);
    Dual<T, N> r;
    r.value = combine(std::span<const T>(values), 1, Demand::value);
    for (const Dual<T, N>& x : f) add_scaled(r, slope(x.value, r.value), x);
    return r;
  }

  /// An operand that is nowhere above 0 adds nothing.
  void keep(std::span<const Interval> f, double /*threshold*/, Demand /*mine*/, std::span<char> kept) const {
    for (size_t i = 0; i < f.size(); ++i) kept[i] = f[i].hi > 0;
  }
  Demand demand_of_operands(Demand mine, size_t count) const { return count == 1 ? mine : Demand::value; }
  void shares(std::span<const double> f, double /*threshold*/, std::span<double> shares) const {
    const double most = std::max(0.0, *std::max_element(f.begin(), f.end())); // no power overflows
    for (size_t i = 0; i < f.size(); ++i) shares[i] = f[i] > 0 ? std::pow(f[i] / most, double(n)) : 0;
    share_by(shares, shares);
  }

private:
  template <class At>
  double total(size_t count, const At& at) const {
    double most = 0;
    for (size_t i = 0; i < count; ++i) most = std::max(most, at(i));
    if (most == 0) return 0;
    double sum = 0;
    for (size_t i = 0; i < count; ++i)
      if (at(i) > 0) sum += std::pow(at(i) / most, double(n));
    return most * std::pow(sum, 1 / double(n));
  }

  double slope(double x, double f) const {
    const double s = x > 0 ? std::pow(x / f, double(n) - 1) : 0;
    return std::isfinite(s) ? s : 0; // at the very end of a support, n < 1: a kink
  }
  Interval slope(Interval x, Interval f) const {
    if (x.hi <= 0) return 0.0;
    const double least = std::max(x.lo, 0.0) / f.hi, most = f.lo > 0 ? std::min(1.0, x.hi / f.lo) : 1;
    const double a = std::pow(least, double(n) - 1), b = std::pow(most, double(n) - 1);
    return {x.lo <= 0 ? 0 : std::min(a, b), std::max(a, b)};
  }
};

} // namespace kelpie
