#pragma once

#include "field/operators/operator.h"

namespace kelpie {

template <class Mode>
struct LocalBlend {
  static constexpr std::string_view k_name = "local_blend";
  static constexpr std::string_view k_doc = R"(A blend where a region is, a union elsewhere.

    f = f_R (f_A + f_B + …) + (1 - f_R) max(f_A, f_B, …),   f_R the region's field, clamped to [0, 1]

The region is any field: where it is 1 or more the children flow together, where it is 0 they only meet; between,
the one becomes the other. So a hand may touch a face without growing into it. Source: methods.md section 2.)";

  typename Mode::Children children;
  typename Mode::Child region{};

  static constexpr auto parameters() {
    return std::tuple{
        parameter("children", &LocalBlend::children, "the fields to join").required(),
        parameter("region", &LocalBlend::region, "the field that says where they flow together").required().as(Role::region),
    };
  }

  // The last operand is the region. Only a child can be left alone, and then is all there is.
  static constexpr bool k_is_positional = true;
  static constexpr Lone k_lone = Lone::itself;

  double combine(std::span<const double> f, double /*threshold*/, Demand /*mine*/) const {
    return mix(
        f.size() - 1, [&](size_t i) { return f[i]; }, clamp(f.back(), 0, 1));
  }
  /// It rises with every child, and is linear in the region.
  Interval combine(std::span<const Interval> f, double /*threshold*/, Demand /*mine*/) const {
    const size_t count = f.size() - 1;
    const Interval region_range = clamp(f.back(), 0, 1);
    const auto lo = [&](size_t i) { return f[i].lo; };
    const auto hi = [&](size_t i) { return f[i].hi; };
    return {std::min(mix(count, lo, region_range.lo), mix(count, lo, region_range.hi)),
            std::max(mix(count, hi, region_range.lo), mix(count, hi, region_range.hi))};
  }
  template <class T, int N>
  Dual<T, N> combine(std::span<const Dual<T, N>> f, double threshold, Demand mine) const {
    const std::span<const Dual<T, N>> parts = f.first(f.size() - 1);
    std::vector<T> values;
    for (const Dual<T, N>& x : f) values.push_back(x.value);
    Dual<T, N> most = parts[0], sum = parts[0];
    for (const Dual<T, N>& x : parts.subspan(1)) most = max(most, x), sum = sum + x;
    const Dual<T, N> r = clamp(f.back(), 0, 1);
    Dual<T, N> out;
    out.value = combine(std::span<const T>(values), threshold, mine);
    const T rest = T(1.0) - r.value, by_region = sum.value - most.value;
    for (int i = 0; i < N; ++i) out.d[i] = r.value * sum.d[i] + rest * most.d[i] + by_region * r.d[i];
    return out;
  }

  /// What is 0 throughout is as good as the constant. A child beside which there is nothing, and that is never negative, needs no region;
  /// nor does an only child, or nothing.
  void keep(std::span<const Interval> f, double /*threshold*/, Demand /*mine*/, std::span<char> kept) const {
    const size_t count = f.size() - 1;
    size_t left = 0, last = 0;
    for (size_t i = 0; i < count; ++i)
      if ((kept[i] = f[i].lo != 0 || f[i].hi != 0)) ++left, last = i;
    if (left == 0 || (left == 1 && (f[last].lo >= 0 || count == 1))) kept[count] = false;
  }
  Demand demand_of_operands(Demand mine, size_t count) const { return count == 1 ? mine : Demand::value; }
  void shares(std::span<const double> f, double /*threshold*/, std::span<double> shares) const {
    const std::span<const double> parts = f.first(f.size() - 1);
    const double in_region = clamp(f.back(), 0, 1);
    share_by(parts, shares.first(parts.size()));
    for (double& share : shares) share *= in_region;
    shares[static_cast<size_t>(std::max_element(parts.begin(), parts.end()) - parts.begin())] += 1 - in_region;
    shares.back() = 0;
  }

private:
  template <class At>
  static double mix(size_t count, const At& at, double in_region) {
    double most = at(0), sum = at(0);
    for (size_t i = 1; i < count; ++i) most = std::max(most, at(i)), sum += at(i);
    return most + in_region * (sum - most);
  }
};

} // namespace kelpie
