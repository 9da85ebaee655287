#include "morph/tree/merged_keys.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "colour/colour.h"

namespace kelpie {

namespace {

/// Of a Hermite curve: 1 + the derivatives that a key may have (scene/read_curve.cpp). Its pieces have the degree 2 n - 1.
constexpr int k_most_order = 5;
/// Where a piece is looked at: so many places, as Chebyshev's series want them, none of them its ends.
constexpr int k_samples = 16;
/// How far a piece may be from the value, as a part of its largest; but float numbers may have lost more on the way to the value, which is
/// seen where it is not straight over the least stretch, in parts of the piece.
constexpr double k_tolerance = 2e-6, k_least_stretch = 1e-3;
/// What is so little out of its range was led there by rounding.
constexpr double k_rounding = 1e-6;
/// No piece is halved that is shorter, in frames: it holds a jump that no break told of, and is a line.
constexpr double k_shortest = 1e-4;
/// The two keys of a jump are so far apart, in frames: nearly the least that scene files may have.
constexpr double k_jump = 2e-6;

template <class T>
struct Parts {
  static constexpr int k_count = 3;
  static std::array<double, 3> of(const Vec3& v) { return {v.x, v.y, v.z}; }
  static std::array<double, 3> of(const Colour& c) { return of(c.rgb); }
  static T whole(const std::array<double, 3>& p) { return T{Vec3(float(p[0]), float(p[1]), float(p[2]))}; }
};
template <>
struct Parts<float> {
  static constexpr int k_count = 1;
  static std::array<double, 1> of(float v) { return {v}; }
  static float whole(const std::array<double, 1>& p) { return float(p[0]); }
};

/// A polynomial on [-1, 1] as a Chebyshev series.
struct Series {
  std::array<double, 2 * k_most_order> c{};

  double at(double x, int degree) const { // Clenshaw's recurrence
    double b1 = 0, b2 = 0;
    for (int k = degree; k > 0; --k) b2 = std::exchange(b1, 2 * x * b1 - b2 + c[size_t(k)]);
    return x * b1 - b2 + c[0];
  }
  /// The i-th derivative at one of its ends.
  double at_end(double side, int i, int degree) const {
    double sum = 0;
    for (int k = 0; k <= degree; ++k) {
      double d = 1;
      for (int j = 0; j < i; ++j) d *= (double(k) * k - double(j) * j) / (2 * j + 1);
      sum += c[size_t(k)] * d * ((k + i) % 2 && side < 0 ? -1 : 1);
    }
    return sum;
  }
};

/// The value between two frames, as polynomials.
template <class T>
struct Piece {
  double from = 0, to = 0;
  std::array<Series, Parts<T>::k_count> series;
  int order = 1;     ///< of the Hermite curve that does
  double error = 0;  ///< of that
  double enough = 0; ///< as large as it may be

  int degree() const { return 2 * order - 1; }
  T end(double side, int derivative) const {
    std::array<double, Parts<T>::k_count> p;
    for (size_t i = 0; i < p.size(); ++i) p[i] = series[i].at_end(side, derivative, degree()) * std::pow(2 / (to - from), derivative);
    return Parts<T>::whole(p);
  }
  std::vector<T> derivatives(double side) const {
    std::vector<T> all;
    for (int i = 1; i < order; ++i) all.push_back(end(side, i));
    return all;
  }
};

template <class T>
class Merger {
public:
  Merger(const Animated<T>& value, const Range& range) : value_(value), range_(range) {}

  MergedKeys<T> run(double first, double last) {
    std::vector<double> frames{first};
    for (const double frame : value_.breaks(first, last))
      if (frame > frames.back() + k_jump && frame < last - k_jump) frames.push_back(frame);
    frames.push_back(last);
    for (size_t i = 1; i < frames.size(); ++i) add_piece(frames[i - 1], frames[i]);
    MergedKeys<T> out;
    for (size_t i = 0; i <= pieces_.size(); ++i)
      add_key(i > 0 ? &pieces_[i - 1] : nullptr, i < pieces_.size() ? &pieces_[i] : nullptr, out);
    for (const Piece<T>& piece : pieces_) out.error = std::max(out.error, piece.error);
    return out;
  }

private:
  using Numbers = std::array<double, Parts<T>::k_count>;

  /// Places in a piece from -1 to 1: zeros of a Chebyshev polynomial.
  static double place(int j) { return std::cos(std::numbers::pi * (j + 0.5) / k_samples); }
  Numbers at(const Piece<T>& piece, double x) const {
    return Parts<T>::of(value_.at(0.5 * (piece.from + piece.to) + 0.5 * (piece.to - piece.from) * x));
  }

  void add_piece(double from, double to) {
    Piece<T> piece{from, to, {}};
    piece.enough = error_allowed(piece);
    find_series(piece);
    find_order(piece);
    const bool is_good = piece.error <= piece.enough && stays_in_range(piece);
    if (!is_good && to - from > k_shortest) {
      add_piece(from, 0.5 * (from + to));
      return add_piece(0.5 * (from + to), to);
    }
    if (!is_good) piece.order = 1, piece.error = 0; // a line between two values
    pieces_.push_back(piece);
  }

  double error_allowed(const Piece<T>& piece) const {
    double largest = 0;
    std::array<double, k_samples> lost{};
    for (int j = 0; j < k_samples; ++j) {
      const double x = place(j) * (1 - k_least_stretch);
      const Numbers before = at(piece, x - k_least_stretch), here = at(piece, x), after = at(piece, x + k_least_stretch);
      double& most = lost[size_t(j)];
      for (size_t i = 0; i < here.size(); ++i)
        largest = std::max(largest, std::abs(here[i])), most = std::max(most, std::abs(before[i] + after[i] - 2 * here[i]));
    }
    std::nth_element(lost.begin(), lost.begin() + k_samples / 2, lost.end()); // not where it has a corner or jumps
    return std::max(k_tolerance * largest, 4 * lost[k_samples / 2]);
  }

  void find_series(Piece<T>& piece) const {
    for (int j = 0; j < k_samples; ++j) {
      const Numbers sample = at(piece, place(j));
      for (size_t part = 0; part < sample.size(); ++part)
        for (size_t k = 0; k < piece.series[part].c.size(); ++k)
          piece.series[part].c[k] +=
              sample[part] * std::cos(double(k) * std::numbers::pi * (j + 0.5) / k_samples) * (k == 0 ? 1 : 2) / k_samples;
    }
  }

  /// The least that does, and its error.
  void find_order(Piece<T>& piece) const {
    for (piece.order = 1;; ++piece.order) {
      piece.error = 0;
      for (int j = 0; j < k_samples && piece.error <= piece.enough; ++j)
        for (const double x : {place(j), -1 + 2 * (j + 0.37) / k_samples}) { // and elsewhere
          const Numbers wanted = at(piece, x);
          for (size_t part = 0; part < wanted.size(); ++part)
            piece.error = std::max(piece.error, std::abs(wanted[part] - piece.series[part].at(x, piece.degree())));
        }
      if (piece.error <= piece.enough || piece.order == k_most_order) return;
    }
  }

  /// Where a value comes near the end of its range, rounding may lead a curve beyond it: looked at as ValueReader does.
  bool stays_in_range(const Piece<T>& piece) const {
    const auto key = [&](double at, double side) {
      return Key<T>{at, within_range(value_.at(at)), piece.derivatives(side), piece.derivatives(side)};
    };
    const Curve<T> curve({key(piece.from, -1), key(piece.to, 1)}, Interpolation::hermite);
    const auto is_in = [&](double frame) {
      const auto parts = Parts<T>::of(curve.at(frame));
      return std::all_of(parts.begin(), parts.end(), [&](double v) { return range_.contains(v); });
    };
    if (!is_in(piece.from)) return true; // nor is the value itself
    for (int j = 1; j <= 8; ++j)
      if (!is_in(piece.from + (piece.to - piece.from) * j / 8)) return false;
    return true;
  }

  /// What rounding has led out of its range.
  T within_range(const T& value) const {
    auto parts = Parts<T>::of(value);
    for (double& v : parts) {
      if (!range_.lower_open && v < range_.lower && v > range_.lower - k_rounding) v = range_.lower;
      if (!range_.upper_open && v > range_.upper && v < range_.upper + k_rounding) v = range_.upper;
    }
    return Parts<T>::whole(parts);
  }

  /// Between two pieces, or at an end.
  void add_key(const Piece<T>* before, const Piece<T>* after, MergedKeys<T>& out) const {
    const double frame = after ? after->from : before->to;
    const T value = within_range(value_.at(frame));
    const auto is_at = [&](const Piece<T>& piece, double side) {
      const auto wanted = Parts<T>::of(value), found = Parts<T>::of(piece.end(side, 0));
      double apart = 0;
      for (size_t i = 0; i < wanted.size(); ++i) apart = std::max(apart, std::abs(wanted[i] - found[i]));
      return apart <= 4 * piece.enough;
    };
    const bool jumps_before = before && !is_at(*before, 1), jumps_after = after && !is_at(*after, -1);
    if (jumps_before) out.keys.push_back({frame - k_jump, within_range(before->end(1, 0)), {}, before->derivatives(1)});
    Key<T> key{frame, value};
    if (after && !jumps_after) key.derivatives = after->derivatives(-1);
    if (before && !jumps_before) {
      std::vector<T> own = before->derivatives(1);
      if (!after || jumps_after)
        key.derivatives = std::move(own);
      else if (!(own == key.derivatives))
        key.derivatives_before = std::move(own);
    } else if (jumps_before) {
      key.derivatives_before.emplace();
    }
    out.keys.push_back(std::move(key));
    if (jumps_after) out.keys.push_back({frame + k_jump, within_range(after->end(-1, 0)), after->derivatives(-1), std::vector<T>{}});
  }

  const Animated<T>& value_;
  Range range_;
  std::vector<Piece<T>> pieces_;
};

} // namespace

template <class T>
MergedKeys<T> merged_keys(const Animated<T>& value, double first, double last, const Range& range) {
  if (value.is_constant()) return {{{first, value.at(first)}}, 0};
  return Merger<T>(value, range).run(first, last);
}

template MergedKeys<float> merged_keys(const Animated<float>&, double, double, const Range&);
template MergedKeys<Vec3> merged_keys(const Animated<Vec3>&, double, double, const Range&);
template MergedKeys<Colour> merged_keys(const Animated<Colour>&, double, double, const Range&);

} // namespace kelpie
