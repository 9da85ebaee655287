#include "field/warps/axis_tube.h"

namespace kelpie {

namespace {

/// Of the widest tube: what is left changes lengths along the axis by no more than a factor of 10.
constexpr double k_part_of_widest = 0.9;
/// The border joins places that differ by less than this part of its width: its slope is at most 1.5 / width, so that what it
/// joins is never turned over.
constexpr double k_limit = 1.0 / 3;
/// So many radii from an axis a point is outside its tube, whatever was rounded.
constexpr double k_past_tube = 1 + 1e-9;

} // namespace

AxisTube::AxisTube(const AxisShape& shape) : AxisTube(shape, make_steps(shape)) {}

AxisTube::AxisTube(const AxisShape& shape, AxisSteps&& steps)
    : deformed_(std::move(steps.deformed)), rest_(std::move(steps.rest)), turns_(std::move(steps.turns)), ends_(std::move(steps.ends)),
      border_(shape.border), limit_part_(k_limit * shape.border), cut_radius_(shape.radius) {
  std::vector<double> reach = deformed_.widest_tube();
  const std::vector<double> at_rest = rest_.widest_tube();
  double size = 0, most = 0;
  for (size_t i = 0; i < reach.size(); ++i) {
    reach[i] = std::min(shape.radius, k_part_of_widest * std::min(reach[i], at_rest[i]));
    if (reach[i] < cut_radius_) cut_radius_ = reach[i], cut_at_ = steps.at[i];
    most_reach_ = std::max(most_reach_, reach[i]);
  }
  for (const AxisTurn& t : turns_) {
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
  const AxisTurn& t = turns_[foot.step];
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

using Ranges = std::array<Interval, 3>;

Interval dot(const Ranges& a, const Ranges& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Interval squared_length(const Ranges& v) { return square(v[0]) + square(v[1]) + square(v[2]); }

/// What part m ± h of a step has, and how far the points of a box are from it.
struct PartRanges {
  double m, h;
  Ranges offset;        ///< from the axis to the points
  Ranges first, second; ///< derivatives of the axis
  Ranges shift, shift_first, shift_second;
  std::array<Ranges, 3> turn, turn_first; ///< [row][column]

  PartRanges(const AxisPart& part, const CubicStep<Vec3d>& axis, const AxisTurn& t, const Box3d& box)
      : m(0.5 * (part.from + part.to)), h(0.5 * (part.to - part.from)) {
    for (int i = 0; i < 3; ++i) {
      const CubicRange c([&](size_t k) { return axis.a[k][i]; }, m, h), s([&](size_t k) { return t.shift.a[k][i]; }, m, h);
      offset[i] = Interval{box.lower[i], box.upper[i]} - c.value;
      first[i] = c.first, second[i] = c.second;
      shift[i] = s.value, shift_first[i] = s.first, shift_second[i] = s.second;
      for (int j = 0; j < 3; ++j) {
        const CubicRange e([&](size_t k) { return t.turn.a[k][j][i]; }, m, h);
        turn[i][j] = e.value, turn_first[i][j] = e.first;
      }
    }
  }
};

/// The slopes of a point's place s on the axis, as in offer_at(). In the tube |c'|^2 - d c'' is at least a tenth of |c'|^2.
Ranges place_slopes(const PartRanges& r, bool may_be_at_end) {
  const Interval speed2 = squared_length(r.first);
  Interval g = speed2 - dot(r.offset, r.second);
  g.lo = std::max(g.lo, 0.05 * speed2.lo), g.hi = std::max(g.hi, g.lo);
  Ranges slopes;
  for (int i = 0; i < 3; ++i) {
    slopes[i] = g.lo > 0 ? r.first[i] / g : Interval{-1e30, 1e30};
    if (may_be_at_end) slopes[i] = hull(slopes[i], 0.0);
  }
  return slopes;
}

/// By how much points are moved, and its slopes, as in offer_at(). What of shift' - turn c' cancels does so at m; around it the
/// derivative bounds it.
void offer_by(const PartRanges& r, const CubicStep<Vec3d>& axis, const AxisTurn& t, const Ranges& s_slopes, AxisOffer<Interval>& out) {
  const Vec3d along_m = t.shift.first(r.m) - t.turn(r.m) * axis.first(r.m);
  for (int i = 0; i < 3; ++i) {
    const Interval change = r.shift_second[i] - dot(r.turn_first[i], r.first) - dot(r.turn[i], r.second);
    const Interval along = intersect(r.shift_first[i] - dot(r.turn[i], r.first), around(along_m[i], r.h * change.magnitude()));
    const Interval by_s = along + dot(r.turn_first[i], r.offset);
    for (int j = 0; j < 3; ++j) out.by_slopes[i][j] = r.turn[i][j] + by_s * s_slopes[j];
    out.by[i] = r.shift[i] + dot(r.turn[i], r.offset);
  }
}

} // namespace

void AxisTube::offer_part(const AxisPart& part, const Box3d& box, Interval distance, AxisOffer<Interval>& out) const {
  const CubicStep<Vec3d>& axis = deformed_.step(part.step);
  const AxisTurn& turn = turns_[part.step];
  const PartRanges r(part, axis, turn, box);
  const Ranges s_slopes = place_slopes(r, part.may_be_at_end);
  offer_by(r, axis, turn, s_slopes, out);

  const Interval length = intersect(sqrt(squared_length(r.offset)), distance);
  const double r0 = deformed_.reach(part.step, part.from), r1 = deformed_.reach(part.step, part.to);
  const Interval reach{std::max(std::min(r0, r1), 1e-300), std::max(std::max(r0, r1), 1e-300)};
  const double reach_slope = deformed_.reach_slope(part.step);
  const Interval u = length / reach;
  out.depth = max(Interval(1.0) - u, Interval(0.0));
  for (int i = 0; i < 3; ++i) {
    const Interval cosine = length.lo > 0 ? intersect(r.offset[i] / length, {-1, 1}) : Interval{-1, 1};
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

bool AxisTube::move(const Vec3d& q, Vec3d& by, double& limit) const {
  AxisFoot foot;
  if (!rest_.find(q, foot)) return false;
  const AxisTurn& t = turns_[foot.step];
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
    const AxisTurn& t = turns_[part.step];
    std::array<Interval, 3> offset;
    Interval distance2(0.0), squared(0.0);
    for (int j = 0; j < 3; ++j) {
      offset[j] = Interval{box.lower[j], box.upper[j]} - CubicRange([&](size_t k) { return r.a[k][j]; }, m, h).value;
      distance2 = distance2 + square(offset[j]);
    }
    const double r0 = rest_.reach(part.step, part.from), r1 = rest_.reach(part.step, part.to);
    const double narrow = std::min(r0, r1), wide = std::max(r0, r1);
    if (distance2.lo > square(k_past_tube * wide)) continue; // the box is outside the tube of this part
    for (int i = 0; i < 3; ++i) {
      Interval by = -CubicRange([&](size_t k) { return t.shift.a[k][i]; }, m, h).value;
      for (int j = 0; j < 3; ++j) by = by + CubicRange([&](size_t k) { return t.turn.a[k][i][j]; }, m, h).value * offset[j];
      squared = squared + square(by);
    }
    out.some = out.some || squared.hi > square(limit_part_ * narrow);
    out.all = out.all && squared.lo > square(limit_part_ * wide);
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
