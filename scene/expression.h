// Formulas of the frame: { "expression": "0.3*sin(2*pi*frame/48)" }.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "base/animated.h"

namespace kelpie {

/// A formula of `frame` and of named values, as muParser reads it.
class Expression {
public:
  /// Throws an Error (bad_data, without a position) that says what is wrong with its syntax.
  explicit Expression(const std::string& text);
  Expression(Expression&&) noexcept;
  ~Expression();

  /// As it was written.
  const std::string& text() const { return text_; }
  /// What it refers to besides `frame`.
  std::vector<std::string> names() const;
  /// Says what a name of names() is; all must be said before the first value is asked for.
  void bind(const std::string& name, Animated<float> value);
  /// Whether it is the same at all frames.
  bool is_constant() const;

  /// From any thread. Infinite or not a number where the formula has no value.
  double at(double frame) const;

private:
  struct Formula;
  std::string text_;
  std::unique_ptr<Formula> formula_;
  std::map<std::string, Animated<float>> values_;
};

/// Why a scene may not call one of its variables so; empty where it may.
std::string problem_of_variable_name(std::string_view name);

} // namespace kelpie
