#pragma once

#include <span>

#include "base/dual.h"
#include "base/kind.h"

namespace kelpie {

template <class Mode>
struct Union {
  static constexpr std::string_view k_name = "union";
  static constexpr std::string_view k_doc = R"(All that is inside one of its children.

    f = max(f_A, f_B, …)

Creased where the surfaces cross. Source: methods.md section 2.)";

  typename Mode::Children children;

  static constexpr auto parameters() {
    return std::tuple{parameter("children", &Union::children, "the fields to unite").required()};
  }

  template <class Real>
  Real combine(std::span<const Real> f, double /*threshold*/) const {
    Real most = f[0];
    for (const Real& x : f.subspan(1)) most = max(most, x);
    return most;
  }
};

} // namespace kelpie
