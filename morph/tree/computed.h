// Values that are computed from other values of the same moment.
#pragma once

#include <algorithm>
#include <tuple>

#include "base/animated.h"
#include "base/time_map.h"

namespace kelpie {

/// In ascending order, each once.
inline std::vector<double> sorted_once(std::vector<double> frames) {
  std::sort(frames.begin(), frames.end());
  frames.erase(std::unique(frames.begin(), frames.end()), frames.end());
  return frames;
}

template <class T, class Function, class... Arguments>
class Computed final : public TimeFunction<T> {
public:
  Computed(Function function, Animated<Arguments>... arguments) : function_(std::move(function)), arguments_(std::move(arguments)...) {}

  T at(double frame) const override {
    return std::apply([&](const auto&... argument) { return function_(argument.at(frame)...); }, arguments_);
  }
  std::vector<double> frames() const override {
    return united([](const auto& argument) { return argument.frames(); });
  }
  std::vector<double> breaks(double from, double to) const override {
    return united([&](const auto& argument) { return argument.breaks(from, to); });
  }

private:
  template <class FramesOf>
  std::vector<double> united(FramesOf&& frames_of) const {
    std::vector<double> all;
    const auto add = [&](const std::vector<double>& frames) { all.insert(all.end(), frames.begin(), frames.end()); };
    std::apply([&](const auto&... argument) { (add(frames_of(argument)), ...); }, arguments_);
    return sorted_once(std::move(all));
  }

  Function function_;
  std::tuple<Animated<Arguments>...> arguments_;
};

/// function(arguments…) at each moment; a constant if all arguments are.
template <class T, class Function, class... Arguments>
Animated<T> computed(Function function, const Animated<Arguments>&... arguments) {
  if ((... && arguments.is_constant())) return function(arguments.at(0)...);
  return Animated<T>(std::make_shared<Computed<T, Function, Arguments...>>(std::move(function), arguments...));
}

/// A value in another time.
template <class T>
class Retimed final : public TimeFunction<T> {
public:
  Retimed(Animated<T> value, const TimeMap& time) : value_(std::move(value)), time_(time) {}

  T at(double frame) const override { return value_.at(time_.at(frame)); }
  std::vector<double> frames() const override { return here(value_.frames()); }
  std::vector<double> breaks(double from, double to) const override { return here(value_.breaks(time_.at(from), time_.at(to))); }

private:
  std::vector<double> here(std::vector<double> frames) const {
    for (double& frame : frames) frame = time_.frame_of(frame);
    return frames;
  }

  Animated<T> value_;
  TimeMap time_; ///< of positive scale
};

template <class T>
Animated<T> retimed(const Animated<T>& value, const TimeMap& time) {
  if (value.is_constant() || time == TimeMap{}) return value;
  return Animated<T>(std::make_shared<Retimed<T>>(value, time));
}

/// (1 - s) a + s b.
template <class T>
Animated<T> mixed(const Animated<T>& a, const Animated<T>& b, const Animated<float>& s) {
  return computed<T>([](const T& x, const T& y, float t) { return t <= 0 ? x : t >= 1 ? y : x * (1 - t) + y * t; }, a, b, s);
}
/// The same, but goes on beyond both ends where s leaves [0, 1].
template <class T>
Animated<T> overshooting(const Animated<T>& a, const Animated<T>& b, const Animated<float>& s) {
  return computed<T>([](const T& x, const T& y, float t) { return t == 0 ? x : t == 1 ? y : x * (1 - t) + y * t; }, a, b, s);
}
/// Held at 0 and 1 where s leaves [0, 1].
inline Animated<float> held(const Animated<float>& s) {
  return computed<float>([](float t) { return std::clamp(t, 0.f, 1.f); }, s);
}
template <class T>
Animated<T> middle(const Animated<T>& a, const Animated<T>& b) {
  return mixed<T>(a, b, 0.5f);
}

/// Of one end, how much of it is left: 1 - s.
inline Animated<float> rest_of(const Animated<float>& s) {
  return computed<float>([](float t) { return 1 - t; }, s);
}

/// From one direction to another about the axis perpendicular to both, and beyond where s leaves [0, 1]; their lengths do not matter, nor
/// which axis it is if they are opposite.
Animated<Vec3> turned(const Animated<Vec3>& a, const Animated<Vec3>& b, const Animated<float>& s);

} // namespace kelpie
