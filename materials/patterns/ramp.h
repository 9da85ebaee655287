// What a pattern ranges over: materials at places between 0 and 1.
#pragma once

#include <span>
#include <vector>

#include "base/kind.h"

namespace kelpie {

/// One material of a pattern, and the value of the pattern where it is.
template <class Mode>
struct Stop {
  static constexpr std::string_view k_name = "stop";
  static constexpr std::string_view k_doc =
      "One of the materials of a pattern: where the pattern has the value `at`, the surface is `material`.";

  Value<Mode, float> at{0.f};
  typename Mode::Material material{};

  static constexpr auto parameters() {
    return std::tuple{
        parameter("at", &Stop::at, "the value of the pattern; between two stops materials are mixed").at_least(0).at_most(1).required(),
        parameter("material", &Stop::material, "a surface, or another pattern").or_named_in("materials").required(),
    };
  }
};

} // namespace kelpie
