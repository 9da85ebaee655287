// A value that may change over time.
#pragma once

#include <memory>

#include "base/curve.h"

namespace kelpie {

/// A constant, or a function of the frame: a curve through keys, a formula.
template <class T>
class Animated {
public:
  Animated() = default;
  Animated(T constant) : constant_(std::move(constant)) {}                                      // NOLINT: a value is an animated value
  Animated(std::shared_ptr<const TimeFunction<T>> function) : function_(std::move(function)) {} // NOLINT: so is a function
  Animated(std::vector<Key<T>> keys, Interpolation how, Ends ends = {}) {
    if (keys.size() == 1) constant_ = keys.front().value;
    if (keys.size() > 1) function_ = std::make_shared<Curve<T>>(std::move(keys), how, ends);
  }

  bool is_constant() const { return !function_; }
  T at(double frame) const { return function_ ? function_->at(frame) : constant_; }
  /// As TimeFunction has them; none of a constant.
  std::vector<double> frames() const { return function_ ? function_->frames() : std::vector<double>{}; }
  std::vector<double> breaks(double from, double to) const { return function_ ? function_->breaks(from, to) : std::vector<double>{}; }
  /// Null of a constant.
  const TimeFunction<T>* function() const { return function_.get(); }
  /// Null if it is a constant, or no curve.
  const Curve<T>* curve() const { return dynamic_cast<const Curve<T>*>(function_.get()); }

private:
  T constant_{}; ///< here and not in a function: most values are constants, and a frame asks for all of them
  std::shared_ptr<const TimeFunction<T>> function_;
};

} // namespace kelpie
