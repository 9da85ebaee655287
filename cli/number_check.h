// Checks of numbers on the command line.
#pragma once

#include <cmath>
#include <limits>
#include <string>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

namespace kelpie {

/// A finite number from `lower` to `upper`. (CLI::Range lets NaN pass, and says limits with all their digits.)
inline CLI::Validator number_between(double lower, double upper = std::numeric_limits<double>::infinity()) {
  const auto check = [=](const std::string& text) {
    double value = 0;
    if (CLI::detail::lexical_cast(text, value) && std::isfinite(value) && value >= lower && value <= upper) return std::string();
    const std::string limits = std::isfinite(upper) ? fmt::format("from {} to {}", lower, upper) : fmt::format(">= {}", lower);
    return fmt::format("must be a number {}, found {}", limits, text);
  };
  return CLI::Validator(check, "");
}

} // namespace kelpie
