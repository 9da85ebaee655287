// Values that follow a formula instead of keys.
#pragma once

#include <array>
#include <mutex>
#include <optional>

#include "base/kind.h"
#include "base/time_function.h"
#include "colour/colour.h"
#include "scene/expression.h"

namespace kelpie {

/// What an expression says. Values and breaks are remembered for a while: at one moment of a scene many others ask for those of a variable.
class Formula final : public TimeFunction<float> {
public:
  /// `frames`: see TimeFunction.
  Formula(Expression expression, std::vector<double> frames);

  /// The formula as it was written.
  std::string text() const { return expression_.text(); }
  float at(double frame) const override;
  std::vector<double> frames() const override { return frames_; }
  /// Found by samples: what turns back, bends or jumps between two of them a 64th of the stretch apart is not noticed.
  std::vector<double> breaks(double from, double to) const override;

private:
  std::vector<double> found_breaks(double from, double to) const;

  struct Breaks {
    double from = 0, to = 0;
    std::vector<double> frames;
  };

  Expression expression_;
  std::vector<double> frames_;
  uint64_t number_; ///< no other formula has had it
  mutable std::mutex breaks_mutex_;
  mutable std::optional<Breaks> last_breaks_;
};

/// A vector or colour whose components change by themselves.
template <class T>
class Components final : public TimeFunction<T> {
public:
  explicit Components(std::array<Animated<float>, 3> parts) : parts_(std::move(parts)) {}

  const std::array<Animated<float>, 3>& parts() const { return parts_; }

  T at(double frame) const override { return T{Vec3(parts_[0].at(frame), parts_[1].at(frame), parts_[2].at(frame))}; }
  std::vector<double> frames() const override {
    return united([](const Animated<float>& part) { return part.frames(); });
  }
  std::vector<double> breaks(double from, double to) const override {
    return united([&](const Animated<float>& part) { return part.breaks(from, to); });
  }

private:
  template <class FramesOf>
  std::vector<double> united(FramesOf&& frames_of) const {
    std::vector<double> all;
    for (const Animated<float>& part : parts_)
      for (const double frame : frames_of(part)) all.push_back(frame);
    std::sort(all.begin(), all.end());
    all.erase(std::unique(all.begin(), all.end()), all.end());
    return all;
  }

  std::array<Animated<float>, 3> parts_;
};

/// A function whose values are looked at each time one is asked for, as nothing that describes it says where it goes.
template <class T>
class Checked final : public TimeFunction<T> {
public:
  /// `what` it is, in errors: "expression", "curve".
  Checked(std::shared_ptr<const TimeFunction<T>> function, ParameterRules rules, SourcePosition where, std::string_view what)
      : function_(std::move(function)), rules_(rules), where_(std::move(where)), what_(what) {}

  const TimeFunction<T>& function() const { return *function_; }
  /// Throws an Error (bad_data) with its position where the value is not what its parameter may be.
  T at(double frame) const override;
  std::vector<double> frames() const override { return function_->frames(); }
  std::vector<double> breaks(double from, double to) const override { return function_->breaks(from, to); }

private:
  std::shared_ptr<const TimeFunction<T>> function_;
  ParameterRules rules_;
  SourcePosition where_;
  std::string_view what_;
};

extern template class Checked<float>;
extern template class Checked<Vec3>;
extern template class Checked<Colour>;

} // namespace kelpie
