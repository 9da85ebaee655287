// A value that may change over time.
#pragma once

#include <algorithm>
#include <vector>

namespace kelpie {

enum class Interpolation { linear, step, hermite };

/// A key: the value at a frame, and (for Hermite interpolation) its derivatives per frame.
template <class T>
struct Key {
  double frame = 0;
  T value{};
  std::vector<T> derivatives{};
};

/// A constant, or keys in strictly ascending order of frame. Before the first and after the last key
/// the value stays at that key's.
///
/// `hermite` is the piecewise Hermite–Ferguson interpolation of order n = 1 + derivatives per key
/// (Barbier, Galin, Akkouche, "animation"): over an interval of length h, u in [0, 1],
///   p = sum_{i<n} h^i [ p0^(i) H_i(u) + (-1)^i p1^(i) H_i(1-u) ],
///   H_i(u) = u^i/i! (1-u)^n sum_{k<n-i} C(n+k-1, k) u^k.
template <class T>
class Animated {
public:
  Animated() = default;
  Animated(T constant) : constant_(std::move(constant)) {} // NOLINT: a value is an animated value
  Animated(std::vector<Key<T>> keys, Interpolation how) : keys_(std::move(keys)), interpolation_(how) {
    if (!keys_.empty()) constant_ = keys_.front().value;
  }

  bool is_constant() const { return keys_.size() < 2; }
  /// None where it was given as a constant.
  const std::vector<Key<T>>& keys() const { return keys_; }
  Interpolation interpolation() const { return interpolation_; }

  T at(double frame) const {
    if (is_constant()) return constant_;
    if (frame <= keys_.front().frame) return keys_.front().value;
    if (frame >= keys_.back().frame) return keys_.back().value;
    const auto next = std::upper_bound(keys_.begin(), keys_.end(), frame, [](double f, const Key<T>& k) { return f < k.frame; });
    const Key<T>&a = *(next - 1), &b = *next;
    const double h = b.frame - a.frame, u = (frame - a.frame) / h;
    switch (interpolation_) {
    case Interpolation::step: return a.value;
    case Interpolation::linear: return a.value * static_cast<float>(1 - u) + b.value * static_cast<float>(u);
    case Interpolation::hermite: return hermite(a, b, h, u);
    }
    return a.value;
  }

private:
  static T hermite(const Key<T>& a, const Key<T>& b, double h, double u) {
    const int n = 1 + static_cast<int>(std::min(a.derivatives.size(), b.derivatives.size()));
    T sum = a.value * static_cast<float>(basis(0, n, u)) + b.value * static_cast<float>(basis(0, n, 1 - u));
    double scale = 1;
    for (int i = 1; i < n; ++i) {
      scale *= h;
      const double sign = i % 2 ? -1 : 1;
      sum = sum + a.derivatives[i - 1] * static_cast<float>(scale * basis(i, n, u)) +
            b.derivatives[i - 1] * static_cast<float>(sign * scale * basis(i, n, 1 - u));
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

  T constant_{}; ///< here and not in a key: most values are constants, and a frame asks for all of them
  std::vector<Key<T>> keys_;
  Interpolation interpolation_ = Interpolation::linear;
};

} // namespace kelpie
