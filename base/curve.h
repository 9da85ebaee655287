// Key frames, and how a value goes on between them and outside.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "base/time_function.h"
#include "base/vec.h"

namespace kelpie {

/// Between two keys. `smooth` and `spline` choose the slopes of a cubic themselves: `smooth` rests at the ends and wherever the value
/// turns back, so it never leaves the values of two neighbours (Fritsch and Butland 1984); `spline` (Catmull and Rom) has at each key the
/// slope of the parabola through it and its neighbours, and may overshoot.
enum class Interpolation { linear, step, hermite, smooth, spline };

/// Before the first key, or after the last. `ping_pong` goes back and forth; `cycle_offset` adds what a cycle has gained, as steps of a
/// walk do; `proceed` goes on in a straight line.
enum class Outside { hold, cycle, cycle_offset, ping_pong, proceed };

/// A key: the value at a frame, and (for Hermite interpolation) its derivatives per frame. Where they are others before the key, the curve
/// has a corner there.
template <class T>
struct Key {
  Key() = default;
  Key(double at, T is, std::vector<T> slopes = {}, std::optional<std::vector<T>> slopes_before = std::nullopt)
      : frame(at), value(std::move(is)), derivatives(std::move(slopes)), derivatives_before(std::move(slopes_before)) {}

  double frame = 0;
  T value{};
  std::vector<T> derivatives;
  std::optional<std::vector<T>> derivatives_before;

  const std::vector<T>& before() const { return derivatives_before ? *derivatives_before : derivatives; }
};

/// How a curve goes on before its first key and after its last.
struct Ends {
  Outside before = Outside::hold, after = Outside::hold;
};

namespace detail {
/// f(a, b) of each component.
template <class F>
float by_component(float a, float b, F&& f) {
  return f(a, b);
}
template <class F>
Vec3 by_component(const Vec3& a, const Vec3& b, F&& f) {
  return Vec3(f(a.x, b.x), f(a.y, b.y), f(a.z, b.z));
}
template <class T, class F>
T by_component(const T& a, const T& b, F&& f) { // a colour
  return T{by_component(a.rgb, b.rgb, f)};
}
} // namespace detail

/// Keys in strictly ascending order of frame, at least one.
///
/// `hermite` is the piecewise Hermite–Ferguson interpolation of order n = 1 + derivatives per key
/// (Barbier, Galin, Akkouche, "animation"): over an interval of length h, u in [0, 1],
///   p = sum_{i<n} h^i [ p0^(i) H_i(u) + (-1)^i p1^(i) H_i(1-u) ],
///   H_i(u) = u^i/i! (1-u)^n sum_{k<n-i} C(n+k-1, k) u^k.
template <class T>
class Curve final : public TimeFunction<T> {
public:
  Curve(std::vector<Key<T>> keys, Interpolation how, Ends ends = {}) : keys_(std::move(keys)), interpolation_(how), ends_(ends) {
    if (how == Interpolation::smooth || how == Interpolation::spline) choose_slopes();
  }

  const std::vector<Key<T>>& keys() const { return keys_; }
  Interpolation interpolation() const { return interpolation_; }
  const Ends& ends() const { return ends_; }

  T at(double frame) const override {
    if (keys_.size() == 1) return keys_.front().value;
    if (frame < first()) return outside(frame, ends_.before, keys_.front(), keys_[1]);
    if (frame > last()) return outside(frame, ends_.after, keys_.back(), keys_[keys_.size() - 2]);
    return between(frame);
  }

  std::vector<double> frames() const override {
    std::vector<double> all;
    for (const Key<T>& key : keys_) all.push_back(key.frame);
    return all;
  }

  std::vector<double> breaks(double from, double to) const override {
    constexpr double k_most_cycles = 64; // more of them in a shutter are a blur, whatever they are
    std::vector<double> all;
    const auto add = [&](double frame) {
      if (frame >= from && frame <= to) all.push_back(frame);
    };
    if (keys_.size() > 1) {
      const double here = std::floor((from - first()) / period());
      const double cycles = std::min(std::floor((to - first()) / period()) - here, k_most_cycles);
      for (double cycle = here; cycle <= here + cycles; ++cycle)
        if (const Outside how = cycle < 0 ? ends_.before : ends_.after; cycle != 0 && repeats(how))
          for (const Key<T>& key : keys_) add(unfolded(key.frame, cycle, how));
    }
    for (const Key<T>& key : keys_) add(key.frame);
    std::sort(all.begin(), all.end());
    return all;
  }

private:
  double first() const { return keys_.front().frame; }
  double last() const { return keys_.back().frame; }
  double period() const { return last() - first(); }
  static bool repeats(Outside how) { return how == Outside::cycle || how == Outside::cycle_offset || how == Outside::ping_pong; }
  static bool is_odd(double cycle) { return std::fmod(std::abs(cycle), 2.0) == 1.0; }

  /// The frame at which `frame`, among the keys, comes again in another cycle.
  double unfolded(double frame, double cycle, Outside how) const {
    const double into = how == Outside::ping_pong && is_odd(cycle) ? last() - frame : frame - first();
    return first() + cycle * period() + into;
  }

  T outside(double frame, Outside how, const Key<T>& end, const Key<T>& next) const {
    if (how == Outside::hold) return end.value;
    if (how == Outside::proceed) return end.value + slope_at(end, next) * float(frame - end.frame);
    const double cycle = std::floor((frame - first()) / period());
    const double into = std::clamp(frame - first() - cycle * period(), 0.0, period());
    const T value = between(how == Outside::ping_pong && is_odd(cycle) ? last() - into : first() + into);
    return how == Outside::cycle_offset ? value + (keys_.back().value + keys_.front().value * -1.f) * float(cycle) : value;
  }

  /// Of the curve at one of its ends.
  T slope_at(const Key<T>& end, const Key<T>& next) const {
    if (interpolation_ == Interpolation::step) return T{};
    const bool is_first = end.frame < next.frame;
    const std::vector<T>& of_end = is_first ? end.derivatives : end.before();
    const std::vector<T>& of_next = is_first ? next.before() : next.derivatives;
    if (of_end.empty() || of_next.empty()) return secant(end, next); // straight between them, too
    return of_end[0];
  }
  static T secant(const Key<T>& a, const Key<T>& b) { return (b.value + a.value * -1.f) * float(1 / (b.frame - a.frame)); }

  T between(double frame) const {
    auto next = std::upper_bound(keys_.begin(), keys_.end(), frame, [](double f, const Key<T>& k) { return f < k.frame; });
    if (next == keys_.end()) return keys_.back().value;
    if (next == keys_.begin()) return keys_.front().value;
    const Key<T>&a = *(next - 1), &b = *next;
    const double h = b.frame - a.frame, u = (frame - a.frame) / h;
    if (interpolation_ == Interpolation::step) return a.value;
    if (interpolation_ == Interpolation::linear) return a.value * static_cast<float>(1 - u) + b.value * static_cast<float>(u);
    return hermite(a, b, h, u);
  }

  static T hermite(const Key<T>& a, const Key<T>& b, double h, double u) {
    const int n = 1 + static_cast<int>(std::min(a.derivatives.size(), b.before().size()));
    T sum = a.value * static_cast<float>(basis(0, n, u)) + b.value * static_cast<float>(basis(0, n, 1 - u));
    double scale = 1;
    for (int i = 1; i < n; ++i) {
      scale *= h;
      const double sign = i % 2 ? -1 : 1;
      sum = sum + a.derivatives[i - 1] * static_cast<float>(scale * basis(i, n, u)) +
            b.before()[i - 1] * static_cast<float>(sign * scale * basis(i, n, 1 - u));
    }
    return sum;
  }

  static double basis(int i, int n, double u) {
    double power = 1, sum = 0, binomial = 1;
    for (int k = 0; k < n - i; ++k) {
      sum += binomial * power;
      power *= u;
      binomial = binomial * (n + k) / (k + 1);
    }
    for (int j = 1; j <= i; ++j) sum *= u / j;
    for (int j = 0; j < n; ++j) sum *= 1 - u;
    return sum;
  }

  /// For the modes that choose them. A curve that repeats has neighbours beyond its ends: a loop closes smoothly.
  void choose_slopes() {
    const size_t n = keys_.size();
    if (n < 2) return;
    const bool is_smooth = interpolation_ == Interpolation::smooth;
    for (size_t i = 1; i + 1 < n; ++i) keys_[i].derivatives = {slope_between(keys_[i - 1], keys_[i], keys_[i], keys_[i + 1])};
    if (closes()) {
      const T joint = slope_between(keys_[n - 2], keys_[n - 1], keys_[0], keys_[1]);
      keys_.front().derivatives = keys_.back().derivatives = {joint};
      return;
    }
    const auto end_slope = [&](Outside how, const Key<T>& a, const Key<T>& b) {
      return is_smooth || how == Outside::ping_pong ? T{} : secant(a, b);
    };
    keys_.front().derivatives = {end_slope(ends_.before, keys_[0], keys_[1])};
    keys_.back().derivatives = {end_slope(ends_.after, keys_[n - 2], keys_[n - 1])};
  }

  /// Whether its last key is its first, a cycle later.
  bool closes() const {
    const auto is = [&](Outside how) { return ends_.before == how || ends_.after == how; };
    if (is(Outside::cycle_offset)) return true;
    return is(Outside::cycle) && keys_.front().value == keys_.back().value;
  }

  /// At a key that ends the stretch a-b and begins c-d.
  T slope_between(const Key<T>& a, const Key<T>& b, const Key<T>& c, const Key<T>& d) const {
    const float h0 = float(b.frame - a.frame), h1 = float(d.frame - c.frame);
    return detail::by_component(secant(a, b), secant(c, d), [&](float s0, float s1) {
      if (interpolation_ == Interpolation::spline) return (s0 * h1 + s1 * h0) / (h0 + h1);
      if (!(s0 * s1 > 0)) return 0.f; // it turns back here
      return 3 * (h0 + h1) / ((2 * h1 + h0) / s0 + (h1 + 2 * h0) / s1);
    });
  }

  std::vector<Key<T>> keys_;
  Interpolation interpolation_ = Interpolation::linear;
  Ends ends_;
};

} // namespace kelpie
