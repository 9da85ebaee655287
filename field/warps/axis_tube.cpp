#include "field/warps/axis_tube.h"

#include <numbers>

#include "base/dual.h"
#include "base/spline.h"

namespace kelpie {

namespace {

/// Of the widest tube: what is left keeps stretches along the axis within a factor of 10.
constexpr double k_part_of_widest = 0.9;
/// The border joins places that differ by less than this part of its width: its slope is at most 1.5 / width, so that what it
/// joins is never turned over.
constexpr double k_limit = 1.0 / 3;
/// Frames are found in this many places of each interval between knots and frames, of which as many become steps as it takes for
/// cubics between them to be this precise (entries of a rotation).
constexpr size_t k_places = 128;
constexpr double k_precision = 1e-6;

/// The coordinate frame of an axis in one place, and its derivative by t: columns x, y, z; z along the axis.
struct Frame {
  Vec3d at, velocity;
  Mat3d axes{1.0}, slopes{0.0};
};

/// A stretch of t that lies in one piece of both splines.
struct Stretch {
  int piece;
  double from, to; ///< within the piece, of [0, 1]
};

CubicStep<Vec3d> polynomial(const Spline<Vec3d>& curve, int piece) {
  CubicStep<Vec3d> out;
  const std::span<const Vec3d> c = curve.coefficients(piece);
  for (size_t i = 0; i < c.size(); ++i) out.a[i] = c[i];
  return out;
}

/// The part [from, to], as a step of its own.
CubicStep<Vec3d> part(const CubicStep<Vec3d>& c, double from, double to) {
  const double h = to - from;
  return {{c(from), h * c.first(from), (0.5 * h * h) * c.second(from), (h * h * h) * c.a[3]}};
}

/// Arc length along a spline, by Gauss's rule.
class ArcLength {
public:
  explicit ArcLength(const Spline<Vec3d>& curve) : curve_(curve), before_{0} {
    for (int i = 0; i < cells(); ++i) before_.push_back(before_.back() + between(i, double(i), double(i + 1)));
  }
  double all() const { return before_.back(); }
  double to(double t) const {
    const double along = std::clamp(t, 0.0, 1.0) * cells();
    const int cell = std::min(static_cast<int>(along), cells() - 1);
    return before_[static_cast<size_t>(cell)] + between(cell, double(cell), along);
  }
  double t_at(double length) const {
    double low = 0, high = 1;
    for (int i = 0; i < 50; ++i) (to(0.5 * (low + high)) < length ? low : high) = 0.5 * (low + high);
    return 0.5 * (low + high);
  }

private:
  static constexpr int k_cells = 16;
  int cells() const { return k_cells * curve_.pieces(); }
  double between(int cell, double from, double to) const {
    constexpr std::array<double, 5> k_x{0, -0.5384693101056831, 0.5384693101056831, -0.9061798459386640, 0.9061798459386640};
    constexpr std::array<double, 5> k_w{0.5688888888888889, 0.4786286704993665, 0.4786286704993665, 0.2369268850561891, 0.2369268850561891};
    const CubicStep<Vec3d> c = polynomial(curve_, cell / k_cells);
    const double half = 0.5 * (to - from) / k_cells, middle = 0.5 * (from + to) / k_cells - cell / k_cells;
    double sum = 0;
    for (size_t i = 0; i < 5; ++i) sum += k_w[i] * glm::length(c.first(middle + half * k_x[i]));
    return sum * half;
  }

  const Spline<Vec3d>& curve_;
  std::vector<double> before_;
};

/// Frames by normal plane projection in the limit of short steps: those that turn about their axis nowhere. By double reflection
/// (Wang, Jüttler, Zheng, Liu 2008, "Computation of rotation minimizing frames"), of fourth order.
class FrameWalk {
public:
  /// `normal` is that at the beginning of the first stretch, or near it.
  explicit FrameWalk(const Vec3d& tangent, const Vec3d& normal) : tangent_(tangent), normal_(normal) { straighten(); }

  Frame go(const CubicStep<Vec3d>& c, double s) {
    const Vec3d at = c(s), first = c.first(s), second = c.second(s);
    const double speed = glm::length(first);
    const Vec3d tangent = speed > 0 ? first / speed : tangent_;
    if (has_begun_) {
      const Vec3d chord = at - at_;
      const double squared = glm::dot(chord, chord);
      if (squared > 0) {
        const auto reflect = [](const Vec3d& v, const Vec3d& by, double by2) { return v - (2 * glm::dot(by, v) / by2) * by; };
        const Vec3d normal = reflect(normal_, chord, squared), turned = tangent - reflect(tangent_, chord, squared);
        const double turned2 = glm::dot(turned, turned);
        normal_ = turned2 > 0 ? reflect(normal, turned, turned2) : normal;
      }
    }
    has_begun_ = true, at_ = at, tangent_ = tangent;
    straighten();
    Frame frame{at, first};
    frame.axes = {glm::cross(normal_, tangent_), normal_, tangent_};
    const Vec3d turn = speed > 0 ? (second - tangent * glm::dot(second, tangent)) / speed : Vec3d(0);
    frame.slopes = {-glm::dot(frame.axes[0], turn) * tangent, -glm::dot(frame.axes[1], turn) * tangent, turn};
    return frame;
  }

private:
  void straighten() { normal_ = glm::normalize(normal_ - tangent_ * glm::dot(normal_, tangent_)); }

  Vec3d at_{0.0}, tangent_, normal_;
  bool has_begun_ = false;
};

/// What of `wanted` is across the tangent; where nothing is, any direction.
Vec3d first_normal(const Vec3d& wanted, const Vec3d& tangent) {
  for (const Vec3d& v : {wanted, Vec3d(0, 1, 0), Vec3d(0, 0, 1), Vec3d(1, 0, 0)}) {
    const Vec3d across = v - tangent * glm::dot(v, tangent);
    if (glm::dot(across, across) > 1e-6 * glm::dot(v, v)) return glm::normalize(across);
  }
  return {0, 1, 0};
}

/// Turned as the shortest turn takes one unit vector to another.
Vec3d carried(const Vec3d& v, const Vec3d& from, const Vec3d& to) {
  const Vec3d middle = from + to;
  const double squared = glm::dot(middle, middle);
  if (squared < 1e-12) return v;                         // right about: v is across both
  const Vec3d once = v - (2 * glm::dot(v, from)) * from; // two reflections make the turn
  return once - (2 * glm::dot(once, middle) / squared) * middle;
}

/// The first direction that a spline has.
Vec3d first_tangent(const Spline<Vec3d>& curve) {
  for (double t = 0; t < 1; t += 1.0 / 64) {
    const Vec3d v = curve.jet(t).first;
    const double length = glm::length(v);
    if (length > 0) return v / length;
  }
  return {0, 0, 1};
}

/// The angle of the frames along the rest axis, and its slope by arc length.
class Roll {
public:
  Roll(const AxisShape& shape, double length) : interpolation_(shape.interpolation) {
    for (const AxisShape::Frame& f : shape.frames) frames_.push_back({f.at * length, f.angle});
    std::stable_sort(frames_.begin(), frames_.end(), [](const auto& a, const auto& b) { return a.at < b.at; });
    // The ends are not turned unless they are said to be.
    if (frames_.empty() || frames_.front().at > 0) frames_.insert(frames_.begin(), {0, 0});
    if (frames_.back().at < length) frames_.push_back({length, 0});
  }
  const std::vector<AxisShape::Frame>& frames() const { return frames_; }

  /// `middle` says between which frames `at` is meant to be.
  std::pair<double, double> angle(double at, double middle) const {
    size_t i = 1;
    while (i + 1 < frames_.size() && frames_[i].at <= middle) ++i;
    const AxisShape::Frame &a = frames_[i - 1], &b = frames_[i];
    const double size = b.at - a.at, pi = std::numbers::pi;
    if (!(size > 0)) return {b.angle, 0};
    const double part = std::clamp((at - a.at) / size, 0.0, 1.0), change = b.angle - a.angle;
    if (interpolation_ == FrameInterpolation::linear) return {a.angle + change * part, change / size};
    return {a.angle + change * 0.5 * (1 - std::cos(pi * part)), change * 0.5 * pi * std::sin(pi * part) / size};
  }

private:
  FrameInterpolation interpolation_;
  std::vector<AxisShape::Frame> frames_;
};

/// A value and its derivative by t.
struct Rotation {
  Mat3d value, slope;
};

/// From the frame of the deformed axis, rolled, to that of the rest axis; less the identity.
Rotation rotation(const Frame& rest, const Frame& deformed, double angle, double angle_slope) {
  const double c = std::cos(angle), s = std::sin(angle);
  const Mat3d &a = deformed.axes, &d = deformed.slopes;
  const Mat3d axes(c * a[0] + s * a[1], c * a[1] - s * a[0], a[2]);
  const Mat3d slopes(c * d[0] + s * d[1] + angle_slope * axes[1], c * d[1] - s * d[0] - angle_slope * axes[0], d[2]);
  return {rest.axes * glm::transpose(axes) - Mat3d(1.0), rest.slopes * glm::transpose(axes) + rest.axes * glm::transpose(slopes)};
}

double most_entry(const Mat3d& m) {
  double most = 0;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) most = std::max(most, std::abs(m[i][j]));
  return most;
}

CubicStep<Mat3d> hermite(const Rotation& a, const Rotation& b, double h) {
  return CubicStep<Mat3d>::hermite(a.value, h * a.slope, b.value, h * b.slope);
}

} // namespace

struct AxisTube::Built {
  std::vector<CubicStep<Vec3d>> deformed, rest;
  std::vector<Turn> turns;
  std::vector<size_t> ends;
  std::vector<double> at; ///< of each node: the part of the rest axis' length
};

AxisTube::Built AxisTube::build(const AxisShape& shape) {
  const Spline<Vec3d> rest = Spline<Vec3d>::b_spline(shape.rest, shape.degree);
  const Spline<Vec3d> deformed = Spline<Vec3d>::b_spline(shape.deformed, shape.degree);
  const ArcLength arc(rest);
  const Roll roll(shape, arc.all());

  // Stretches end at knots and at frames: between them all is smooth.
  std::vector<double> ends;
  for (int i = 0; i <= rest.pieces(); ++i) ends.push_back(i);
  for (const AxisShape::Frame& f : roll.frames()) ends.push_back(arc.t_at(f.at) * rest.pieces());
  std::sort(ends.begin(), ends.end());
  std::vector<Stretch> stretches;
  for (size_t i = 1; i < ends.size(); ++i) {
    const int piece = std::min(static_cast<int>(0.5 * (ends[i - 1] + ends[i])), rest.pieces() - 1);
    // A shorter one joins its neighbour: a roundings' length off a knot.
    if (ends[i] - ends[i - 1] < 1e-9)
      ends[i] = ends[i - 1];
    else
      stretches.push_back({piece, ends[i - 1] - piece, ends[i] - piece});
  }

  const Vec3d tangent = first_tangent(rest), deformed_tangent = first_tangent(deformed);
  const Vec3d normal = first_normal(shape.normal, tangent);
  FrameWalk rest_walk(tangent, normal), deformed_walk(deformed_tangent, carried(normal, tangent, deformed_tangent));
  Built out;
  for (const Stretch& stretch : stretches) {
    const CubicStep<Vec3d> r = part(polynomial(rest, stretch.piece), stretch.from, stretch.to);
    const CubicStep<Vec3d> c = part(polynomial(deformed, stretch.piece), stretch.from, stretch.to);
    const auto length_at = [&](double s) {
      return arc.to((stretch.piece + stretch.from + s * (stretch.to - stretch.from)) / rest.pieces());
    };
    const double middle = length_at(0.5);
    std::vector<Rotation> rotations;
    for (size_t i = 0; i <= k_places; ++i) {
      const double s = double(i) / k_places;
      const Frame at_rest = rest_walk.go(r, s), at = deformed_walk.go(c, s);
      const auto [angle, slope] = roll.angle(length_at(s), middle);
      rotations.push_back(rotation(at_rest, at, angle, slope * glm::length(at_rest.velocity)));
    }
    size_t stride = k_places / 2;
    const auto is_precise = [&] {
      for (size_t i = 0; i < k_places; i += stride) {
        const CubicStep<Mat3d> step = hermite(rotations[i], rotations[i + stride], double(stride) / k_places);
        if (!(most_entry(step(0.5) - rotations[i + stride / 2].value) < k_precision)) return false;
      }
      return true;
    };
    while (stride > 2 && !is_precise()) stride /= 2;
    for (size_t i = 0; i < k_places; i += stride) {
      const double from = double(i) / k_places, to = double(i + stride) / k_places;
      out.rest.push_back(part(r, from, to)), out.deformed.push_back(part(c, from, to));
      Turn turn{{}, hermite(rotations[i], rotations[i + stride], to - from)};
      for (size_t k = 0; k < 4; ++k) turn.shift.a[k] = out.rest.back().a[k] - out.deformed.back().a[k];
      out.turns.push_back(turn);
      out.at.push_back(length_at(from) / std::max(arc.all(), 1e-300));
    }
    out.ends.resize(out.turns.size(), out.turns.size());
  }
  out.at.push_back(1);
  return out;
}

AxisTube::AxisTube(const AxisShape& shape) : AxisTube(shape, build(shape)) {}

AxisTube::AxisTube(const AxisShape& shape, Built&& built)
    : deformed_(std::move(built.deformed)), rest_(std::move(built.rest)), turns_(std::move(built.turns)), ends_(std::move(built.ends)),
      border_(shape.border), limit_part_(k_limit * shape.border), cut_radius_(shape.radius) {
  std::vector<double> reach = deformed_.widest_tube();
  const std::vector<double> at_rest = rest_.widest_tube();
  double size = 0, most = 0;
  for (size_t i = 0; i < reach.size(); ++i) {
    reach[i] = std::min(shape.radius, k_part_of_widest * std::min(reach[i], at_rest[i]));
    if (reach[i] < cut_radius_) cut_radius_ = reach[i], cut_at_ = built.at[i];
    most_reach_ = std::max(most_reach_, reach[i]);
  }
  for (const Turn& t : turns_) {
    size = std::max(size, glm::length(t.shift.a[0]));
    for (const double s : {0.0, 0.5, 1.0}) most = std::max(most, glm::length(t.shift(s)) + most_entry(t.turn(s)) * most_reach_);
  }
  moves_ = most > 1e-12 * (size + most_reach_);
  deformed_.set_reach(reach), rest_.set_reach(std::move(reach));
}

bool AxisTube::offer(const Vec3d& p, bool with_slopes, AxisOffer<double>& out) const {
  AxisFoot foot;
  if (!deformed_.find(p, foot)) return false;
  offer_at(foot, with_slopes, out);
  return true;
}

void AxisTube::offer_at(const AxisFoot& foot, bool with_slopes, AxisOffer<double>& out) const {
  const Turn& t = turns_[foot.step];
  const Mat3d turn = t.turn(foot.s);
  const Vec3d by = t.shift(foot.s) + turn * foot.offset;
  out.by = {by.x, by.y, by.z};
  out.depth = 1 - foot.distance / foot.reach;
  out.limit = foot.reach * limit_part_, out.border = border_;
  if (!with_slopes) return;
  // With d = p - c(s) across c'(s): ds = c' dp / (|c'|^2 - d c''), and by = shift(s) + turn(s) d.
  const Vec3d s_slopes = foot.is_at_end ? Vec3d(0) : foot.first / (glm::dot(foot.first, foot.first) - glm::dot(foot.offset, foot.second));
  const Vec3d by_s = t.shift.first(foot.s) - turn * foot.first + t.turn.first(foot.s) * foot.offset;
  const Vec3d distance_slopes = foot.distance > 0 ? foot.offset / foot.distance : Vec3d(0);
  const double reach_slope = deformed_.reach_slope(foot.step);
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) out.by_slopes[i][j] = turn[j][i] + by_s[i] * s_slopes[j];
    out.depth_slopes[i] = (foot.distance / foot.reach * reach_slope * s_slopes[i] - distance_slopes[i]) / foot.reach;
    out.limit_slopes[i] = limit_part_ * reach_slope * s_slopes[i];
  }
}

namespace {

/// A cubic and its first derivatives over the part m ± h of a step, by Taylor's series about m.
struct CubicRange {
  Interval value, first, second;
  template <class Get>
  CubicRange(const Get& a, double m, double h) {
    const double v = a(0) + m * (a(1) + m * (a(2) + m * a(3))), d = a(1) + m * (2 * a(2) + 3 * m * a(3));
    const double dd = 2 * a(2) + 6 * m * a(3), ddd = std::abs(6 * a(3));
    const double wide = h * (std::abs(d) + h * (0.5 * std::abs(dd) + h / 6 * ddd)), wide_first = h * (std::abs(dd) + 0.5 * h * ddd);
    value = {v - wide, v + wide}, first = {d - wide_first, d + wide_first}, second = {dd - h * ddd, dd + h * ddd};
  }
};

Interval around(double middle, double half) { return {middle - half, middle + half}; }

} // namespace

void AxisTube::offer_part(const AxisPart& part, const Box3d& box, Interval distance, AxisOffer<Interval>& out) const {
  const double m = 0.5 * (part.from + part.to), h = 0.5 * (part.to - part.from);
  const CubicStep<Vec3d>& c = deformed_.step(part.step);
  const Turn& t = turns_[part.step];
  std::array<Interval, 3> offset, first, second, shift_first, shift_second, shift;
  for (int i = 0; i < 3; ++i) {
    const CubicRange axis([&](size_t k) { return c.a[k][i]; }, m, h), s([&](size_t k) { return t.shift.a[k][i]; }, m, h);
    offset[i] = Interval{box.lower[i], box.upper[i]} - axis.value;
    first[i] = axis.first, second[i] = axis.second;
    shift[i] = s.value, shift_first[i] = s.first, shift_second[i] = s.second;
  }
  std::array<std::array<Interval, 3>, 3> turn, turn_first; // [row][column]
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      const CubicRange e([&](size_t k) { return t.turn.a[k][j][i]; }, m, h);
      turn[i][j] = e.value, turn_first[i][j] = e.first;
    }
  const auto dot = [](const auto& a, const auto& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; };

  // The slopes of s. In the tube |c'|^2 - d c'' is at least a tenth of |c'|^2.
  const Interval speed2 = square(first[0]) + square(first[1]) + square(first[2]);
  Interval g = speed2 - dot(offset, second);
  g.lo = std::max(g.lo, 0.05 * speed2.lo), g.hi = std::max(g.hi, g.lo);
  std::array<Interval, 3> s_slopes;
  for (int i = 0; i < 3; ++i) {
    s_slopes[i] = g.lo > 0 ? first[i] / g : Interval{-1e30, 1e30};
    if (part.may_be_at_end) s_slopes[i] = hull(s_slopes[i], 0.0);
  }

  // What of shift' - turn c' cancels does so at m; around it the derivative bounds it.
  const Mat3d turn_m = t.turn(m);
  const Vec3d along_m = t.shift.first(m) - turn_m * c.first(m);
  for (int i = 0; i < 3; ++i) {
    const Interval change = shift_second[i] - dot(turn_first[i], first) - dot(turn[i], second);
    const Interval by_s =
        intersect(shift_first[i] - dot(turn[i], first), around(along_m[i], h * change.magnitude())) + dot(turn_first[i], offset);
    for (int j = 0; j < 3; ++j) out.by_slopes[i][j] = turn[i][j] + by_s * s_slopes[j];
    out.by[i] = shift[i] + dot(turn[i], offset);
  }

  const Interval length = intersect(sqrt(square(offset[0]) + square(offset[1]) + square(offset[2])), distance);
  const double r0 = deformed_.reach(part.step, part.from), r1 = deformed_.reach(part.step, part.to);
  const Interval reach{std::max(std::min(r0, r1), 1e-300), std::max(std::max(r0, r1), 1e-300)};
  const double reach_slope = deformed_.reach_slope(part.step);
  const Interval u = length / reach;
  out.depth = max(Interval(1.0) - u, Interval(0.0));
  for (int i = 0; i < 3; ++i) {
    const Interval cosine = length.lo > 0 ? intersect(offset[i] / length, {-1, 1}) : Interval{-1, 1};
    out.depth_slopes[i] = (min(u, Interval(1.0)) * (reach_slope * s_slopes[i]) - cosine) / reach;
  }
  out.limit = reach * limit_part_;
}

bool AxisTube::offer(const Box3d& box, AxisOffer<Interval>& out) const {
  thread_local AxisRange range;
  deformed_.find(box, range);
  if (range.parts.empty()) return false;
  const Vec3d half = box.extent() * 0.5;
  Interval distance{0, INFINITY};
  AxisOffer<double> middle;
  if (range.is_inside) {
    const double radius = glm::length(half);
    distance = {std::max(0.0, range.centre.distance - radius), range.centre.distance + radius};
    offer_at(range.centre, false, middle);
  }
  out.border = border_;
  bool is_first = true;
  for (const AxisPart& part : range.parts) {
    AxisOffer<Interval> one;
    offer_part(part, box, distance, one);
    if (is_first) {
      out = one, out.border = border_;
    } else {
      for (int i = 0; i < 3; ++i) {
        out.by[i] = hull(out.by[i], one.by[i]), out.depth_slopes[i] = hull(out.depth_slopes[i], one.depth_slopes[i]);
        for (int j = 0; j < 3; ++j) out.by_slopes[i][j] = hull(out.by_slopes[i][j], one.by_slopes[i][j]);
      }
      out.depth = hull(out.depth, one.depth), out.limit = hull(out.limit, one.limit);
    }
    is_first = false;
  }
  if (!range.is_inside) { // some points are outside
    out.depth = hull(out.depth, 0.0);
    for (Interval& d : out.depth_slopes) d = hull(d, 0.0);
  } else { // the mean-value form
    for (int i = 0; i < 3; ++i) {
      double reach = 0;
      for (int j = 0; j < 3; ++j) reach += out.by_slopes[i][j].magnitude() * half[j];
      out.by[i] = intersect(out.by[i], around(middle.by[i], reach));
    }
  }
  return true;
}

namespace {

/// Newton's method may go this far beyond the stretch that holds the places of a box.
constexpr double k_room = 1.5;

/// The polynomial of degree 4 through values at five places.
std::array<Mat3d, 5> interpolated(const std::array<double, 5>& x, std::array<Mat3d, 5> values) {
  for (size_t k = 1; k < 5; ++k)
    for (size_t j = 4; j >= k; --j) values[j] = (values[j] - values[j - 1]) / (x[j] - x[j - k]);
  std::array<Mat3d, 5> powers;
  powers.fill(Mat3d(0.0));
  for (size_t j = 5; j-- > 0;) {
    for (size_t k = 4; k > 0; --k) powers[k] = powers[k - 1] - x[j] * powers[k];
    powers[0] = values[j] - x[j] * powers[0];
  }
  return powers;
}

/// How many of Newton's steps from u = 0 find a piece's place for every point of a box, where that lies in [-h, h]; 0 if they may not.
/// Makes h smaller, if places surely lie in less.
int newton_steps(const AxisPiece& piece, const Vec3d& half, double& h) {
  constexpr double k_precise = 1e-6;
  constexpr int k_most = 7;
  const auto& a = piece.axis;
  const auto along = [&](const Vec3d& v) {
    const double middle = glm::dot(v, piece.offset), width = glm::dot(glm::abs(v), half);
    return Interval{middle - width, middle + width};
  };
  // Of f(u) = (offset + d - dc) c', the derivatives.
  const double aa = glm::dot(a[0], a[0]), ab = glm::dot(a[0], a[1]), n2 = 2 * glm::dot(a[1], a[1]) + 4 * glm::dot(a[0], a[2]);
  const double n3 = 5 * glm::dot(a[1], a[2]), n4 = 3 * glm::dot(a[2], a[2]);
  const Interval f2 = 3.0 * along(a[2]) - 3 * ab;
  const auto falls = [&](const Interval& u) {
    return aa - 2.0 * along(a[1]) - u * (2.0 * f2 - u * (3 * n2 + u * (4 * n3 + u * (5 * n4))));
  };
  const double most = along(a[0]).magnitude(); // of f(0)
  for (int i = 0; i < 3; ++i)
    if (const double least = falls({-h, h}).lo; least > 0) h = std::min(h, most / least);
  const Interval u{-k_room * h, k_room * h};
  const Interval bends = 2.0 * f2 - u * (6 * n2 + u * (12 * n3 + u * (20 * n4)));
  const double least = falls(u).lo;
  if (!(least > 0)) return 0;
  const double factor = 0.5 * bends.magnitude() / least;
  int steps = 0;
  for (double error = h; error > k_precise * h; ++steps) {
    if (steps == k_most || factor * error > 0.7) return 0;
    error *= factor * error;
  }
  return std::max(steps, 1);
}

} // namespace

/// In terms of s of `step`, places from `from` to `to`, which may lie beyond its ends in the same stretch.
bool AxisTube::fit(size_t step, double from, double to, const Box3d& box, double tolerance, AxisPiece& out) const {
  const double middle = 0.5 * (from + to), h = std::max(0.5 * (to - from), 1e-6);
  const size_t end = ends_[step];
  const auto in_step = [&](double s, size_t& k) {
    k = std::min(step + static_cast<size_t>(std::max(s, 0.0)), end - 1);
    return s - static_cast<double>(k - step);
  };
  size_t k = 0;
  const auto turn_at = [&](double u) {
    const double s = in_step(middle + u, k);
    return turns_[k].turn(s);
  };
  const double at = in_step(middle, k);
  const CubicStep<Vec3d>&c = deformed_.step(k), &shift = turns_[k].shift;
  out.joint = static_cast<double>(end - step) - middle;
  out.offset = box.centre() - c(at);
  out.axis = {c.first(at), 0.5 * c.second(at), c.a[3]};
  out.shift = {shift(at), shift.first(at), 0.5 * shift.second(at), shift.a[3]};
  constexpr std::array<double, 5> k_nodes{-0.9510565162951535, -0.5877852522924731, 0, 0.5877852522924731, 0.9510565162951535};
  std::array<Mat3d, 5> values;
  for (size_t i = 0; i < 5; ++i) values[i] = turn_at(h * k_nodes[i]);
  const std::array<Mat3d, 5> powers = interpolated(k_nodes, values);
  double error = 0;
  for (const double x : {-1.0, -0.8, -0.3, 0.3, 0.8, 1.0})
    error = std::max(error, most_entry(powers[0] + x * (powers[1] + x * (powers[2] + x * (powers[3] + x * powers[4]))) - turn_at(h * x)));
  if (!(error * most_reach_ <= tolerance + 2 * k_precision * most_reach_)) return false;
  double power = 1;
  for (size_t i = 0; i < 5; ++i, power *= h) out.turn[i] = powers[i] / power;
  double places = h;
  out.newton_steps = newton_steps(out, box.extent() * 0.5, places);
  out.low = -k_room * places, out.high = k_room * places;
  if (step == 0) out.low = std::max(out.low, -middle);
  if (end == turns_.size()) out.high = std::min(out.high, out.joint);
  return out.newton_steps > 0;
}

bool AxisTube::pieces(const Box3d& box, double tolerance, std::vector<AxisPiece>& out) const {
  thread_local AxisRange range;
  deformed_.find(box, range);
  out.clear();
  if (!range.is_inside) return false;
  const std::vector<AxisPart>& parts = range.parts;
  for (size_t i = 0; i < parts.size();) {
    size_t last = i;
    while (last + 1 < parts.size() && parts[last + 1].step < ends_[parts[i].step]) ++last;
    const double to = static_cast<double>(parts[last].step - parts[i].step) + parts[last].to;
    if (!fit(parts[i].step, parts[i].from, to, box, tolerance, out.emplace_back())) return false;
    i = last + 1;
  }
  return true;
}

bool AxisTube::move(const Vec3d& q, Vec3d& by, double& limit) const {
  AxisFoot foot;
  if (!rest_.find(q, foot)) return false;
  const Turn& t = turns_[foot.step];
  // From the rest frame to the deformed one the rotation is the transpose.
  by = -t.shift(foot.s) + foot.offset * t.turn(foot.s);
  limit = foot.reach * limit_part_;
  return true;
}

AxisTube::Moved AxisTube::moved(const Box3d& box) const {
  thread_local AxisRange range;
  rest_.find(box, range);
  Moved out;
  out.all = range.is_inside;
  for (const AxisPart& part : range.parts) {
    const double m = 0.5 * (part.from + part.to), h = 0.5 * (part.to - part.from);
    const CubicStep<Vec3d>& r = rest_.step(part.step);
    const Turn& t = turns_[part.step];
    Interval squared(0.0);
    for (int i = 0; i < 3; ++i) {
      Interval by = -CubicRange([&](size_t k) { return t.shift.a[k][i]; }, m, h).value;
      for (int j = 0; j < 3; ++j) {
        const CubicRange axis([&](size_t k) { return r.a[k][j]; }, m, h), e([&](size_t k) { return t.turn.a[k][i][j]; }, m, h);
        by = by + e.value * (Interval{box.lower[j], box.upper[j]} - axis.value);
      }
      squared = squared + square(by);
    }
    const double r0 = limit_part_ * rest_.reach(part.step, part.from), r1 = limit_part_ * rest_.reach(part.step, part.to);
    out.some = out.some || squared.hi > square(std::min(r0, r1));
    out.all = out.all && squared.lo > square(std::max(r0, r1));
  }
  out.all = out.all && out.some;
  return out;
}

void AxisTube::extend_image(const Box3d& rest, Box3d& image) const {
  const Box3d near = rest.padded(most_limit());
  for (size_t i = 0; i < turns_.size(); ++i)
    if (!intersect(rest_.box(i), near).is_empty()) image.extend(deformed_.box(i));
}

} // namespace kelpie
