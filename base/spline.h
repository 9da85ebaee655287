// Curves from control points: clamped B-splines, Bézier curves and Catmull-Rom splines, all of them polynomials in pieces.
#pragma once

#include <algorithm>
#include <cassert>
#include <span>
#include <vector>

namespace kelpie {

enum class SplineKind {
  b_spline,      ///< stays near its control points, and begins and ends in the first and the last one
  bezier,        ///< one polynomial for all; the same ends
  cubic_beziers, ///< cubic Bézier curves one after the other: each begins where the one before ends
  catmull_rom,   ///< goes through its control points
};

/// A curve and its derivatives by t.
template <class Point>
struct SplineJet {
  Point value, first, second;
};

/// A curve over t in [0, 1], in pieces of equal length of t, each a polynomial. `Point`: double, or a vector of doubles.
template <class Point>
class Spline {
public:
  /// Of `degree`, with uniform knots that are clamped: count - degree pieces. Fewer points than degree + 1 lower the degree.
  /// There must be a point. Continuous up to the derivative degree - 1. Source: Piegl, Tiller, The NURBS Book, chapter 3.
  static Spline b_spline(std::span<const Point> control, int degree = 3) {
    const int count = static_cast<int>(control.size()), p = std::min(degree, count - 1), pieces = count - p;
    Spline out(std::max(p, 0), std::max(pieces, 1));
    if (p == 0) { // lone points: each is a piece
      for (int i = 0; i < pieces; ++i) out.coefficients_[static_cast<size_t>(i)] = control[static_cast<size_t>(i)];
      return out;
    }
    std::vector<double> knots(static_cast<size_t>(count + p + 1));
    for (int i = 0; i <= count + p; ++i) knots[static_cast<size_t>(i)] = std::clamp(i - p, 0, pieces);
    // Taylor's series at the beginning of each piece: derivatives of a B-spline are B-splines of the differences.
    std::vector<Point> points(control.begin(), control.end());
    double factorial = 1;
    for (int k = 0; k <= p; ++k) {
      for (int piece = 0; piece < pieces; ++piece)
        out.coefficient(piece, k) = de_boor(std::span<const Point>(points), std::span<const double>(knots), p - k, piece) * (1 / factorial);
      for (size_t i = 0; i + 1 < points.size(); ++i) {
        const double span = knots[i + static_cast<size_t>(p - k) + 1] - knots[i + 1];
        points[i] = (points[i + 1] - points[i]) * (static_cast<double>(p - k) / span);
      }
      points.pop_back(), knots.pop_back(), knots.erase(knots.begin());
      factorial *= k + 1;
    }
    return out;
  }

  /// Of as many degrees as there are points, less one: a B-spline without inner knots.
  static Spline bezier(std::span<const Point> control) { return b_spline(control, static_cast<int>(control.size()) - 1); }

  /// Each piece has four of the points, the last of them in common with the next: as drawing programs write paths. One or two points that
  /// are left over make a last piece of lower degree.
  static Spline cubic_beziers(std::span<const Point> control) {
    const size_t n = control.size();
    if (n == 1) return b_spline(control);
    Spline out(3, static_cast<int>((n + 1) / 3));
    for (size_t i = 0; i + 1 < n; i += 3) {
      const Spline piece = bezier(control.subspan(i, std::min<size_t>(4, n - i)));
      std::copy(piece.coefficients_.begin(), piece.coefficients_.end(),
                out.coefficients_.begin() + static_cast<std::ptrdiff_t>(4 * (i / 3)));
    }
    return out;
  }

  /// Cubic and once continuously differentiable: at each point the derivative is that of the chord between its neighbours,
  /// at the ends of the chord to the neighbour. count - 1 pieces.
  static Spline catmull_rom(std::span<const Point> control) {
    const size_t n = control.size();
    if (n == 1) return b_spline(control);
    Spline out(3, static_cast<int>(n) - 1);
    const auto slope = [&](size_t i) {
      const size_t before = i > 0 ? i - 1 : 0, after = std::min(i + 1, n - 1);
      return (control[after] - control[before]) * (1.0 / static_cast<double>(after - before));
    };
    for (size_t i = 0; i + 1 < n; ++i) {
      const Point chord = control[i + 1] - control[i], a = slope(i), b = slope(i + 1);
      Point* c = &out.coefficients_[4 * i];
      c[0] = control[i], c[1] = a, c[2] = chord * 3.0 - a * 2.0 - b, c[3] = a + b - chord * 2.0;
    }
    return out;
  }

  static Spline make(SplineKind kind, std::span<const Point> control, int degree = 3) {
    return kind == SplineKind::bezier          ? bezier(control)
           : kind == SplineKind::cubic_beziers ? cubic_beziers(control)
           : kind == SplineKind::catmull_rom   ? catmull_rom(control)
                                               : b_spline(control, degree);
  }

  int degree() const { return degree_; }
  int pieces() const { return pieces_; }
  /// Of the powers of s in [0, 1] on a piece, degree() + 1 of them: piece i is t from i / pieces() on.
  std::span<const Point> coefficients(int piece) const {
    return std::span(coefficients_).subspan(static_cast<size_t>(piece) * stride(), stride());
  }

  /// Outside [0, 1] the end's polynomial goes on.
  Point operator()(double t) const {
    const Place at = place(t);
    Point value = at.c[degree_];
    for (int k = degree_ - 1; k >= 0; --k) value = value * at.s + at.c[k];
    return value;
  }

  SplineJet<Point> jet(double t) const {
    const Place at = place(t);
    Point value = at.c[degree_], first = value * 0.0, second = first;
    for (int k = degree_ - 1; k >= 0; --k) {
      second = second * at.s + first * 2.0;
      first = first * at.s + value;
      value = value * at.s + at.c[k];
    }
    return {value, first * static_cast<double>(pieces_), second * (static_cast<double>(pieces_) * pieces_)};
  }

private:
  Spline(int degree, int pieces) : degree_(degree), pieces_(pieces), coefficients_(static_cast<size_t>(pieces) * stride()) {}

  struct Place {
    const Point* c;
    double s;
  };
  size_t stride() const { return static_cast<size_t>(degree_) + 1; }
  Point& coefficient(int piece, int power) { return coefficients_[static_cast<size_t>(piece) * stride() + static_cast<size_t>(power)]; }
  Place place(double t) const {
    const double along = t * pieces_;
    const int piece = along < 1 ? 0 : along >= pieces_ - 1 ? pieces_ - 1 : static_cast<int>(along);
    return {&coefficients_[static_cast<size_t>(piece) * stride()], along - piece};
  }

  /// The spline at the beginning of a piece: of its `degree` + 1 points, which begin with points[piece].
  static Point de_boor(std::span<const Point> points, std::span<const double> knots, int degree, int piece) {
    std::vector<Point> d(points.begin() + piece, points.begin() + piece + degree + 1);
    const double t = piece;
    for (int r = 1; r <= degree; ++r)
      for (int j = degree; j >= r; --j) {
        const double from = knots[static_cast<size_t>(j + piece)], to = knots[static_cast<size_t>(j + 1 + piece + degree - r)];
        const double a = (t - from) / (to - from);
        d[static_cast<size_t>(j)] = d[static_cast<size_t>(j - 1)] * (1 - a) + d[static_cast<size_t>(j)] * a;
      }
    return d[static_cast<size_t>(degree)];
  }

  int degree_, pieces_;
  std::vector<Point> coefficients_;
};

} // namespace kelpie
