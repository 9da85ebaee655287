#pragma once

#include <span>

#include "base/dual.h"
#include "base/kind.h"

namespace kelpie {

template <class Mode>
struct Blend {
  static constexpr std::string_view k_name = "blend";
  static constexpr std::string_view k_doc = R"(The sum of its children: they flow together where they meet.

    f = f_A + f_B + …

Source: methods.md section 2.)";

  typename Mode::Children children;

  static constexpr auto parameters() {
    return std::tuple{parameter("children", &Blend::children, "the fields to add").required()};
  }

  template <class Real>
  Real combine(std::span<const Real> f, double /*threshold*/) const {
    Real sum = f[0];
    for (const Real& x : f.subspan(1)) sum = sum + x;
    return sum;
  }
};

} // namespace kelpie
