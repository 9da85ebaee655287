#pragma once

#include <span>

#include "base/dual.h"
#include "base/kind.h"

namespace kelpie {

template <class Mode>
struct Intersection {
  static constexpr std::string_view k_name = "intersection";
  static constexpr std::string_view k_doc = R"(All that is inside every one of its children.

    f = min(f_A, f_B, …)

Creased where the surfaces cross. Source: methods.md section 2.)";

  typename Mode::Children children;

  static constexpr auto parameters() {
    return std::tuple{parameter("children", &Intersection::children, "the fields to intersect").required()};
  }

  template <class Real>
  Real combine(std::span<const Real> f, double /*threshold*/) const {
    Real least = f[0];
    for (const Real& x : f.subspan(1)) least = min(least, x);
    return least;
  }
};

} // namespace kelpie
