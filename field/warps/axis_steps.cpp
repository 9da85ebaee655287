#include "field/warps/axis_steps.h"

#include <numbers>

#include "field/warps/axis_length.h"
#include "field/warps/frame_walk.h"

namespace kelpie {

namespace {

/// Frames are found in this many places of each section, of which as many become steps as it takes for cubics between them to be as
/// precise as k_frame_precision.
constexpr size_t k_places = 128;

/// A part of both splines between knots and frames, where all is smooth.
struct Section {
  int piece;
  double from, to; ///< within the piece, of [0, 1]

  double place(double s) const { return piece + from + s * (to - from); } ///< in pieces, for s in [0, 1]
};

/// The part [from, to], as a step of its own.
CubicStep<Vec3d> part(const CubicStep<Vec3d>& c, double from, double to) {
  const double h = to - from;
  return {{c(from), h * c.first(from), (0.5 * h * h) * c.second(from), (h * h * h) * c.a[3]}};
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
Rotation rotation(const CurveFrame& rest, const CurveFrame& deformed, double angle, double angle_slope) {
  const double c = std::cos(angle), s = std::sin(angle);
  const Mat3d &a = deformed.axes, &d = deformed.slopes;
  const Mat3d axes(c * a[0] + s * a[1], c * a[1] - s * a[0], a[2]);
  const Mat3d slopes(c * d[0] + s * d[1] + angle_slope * axes[1], c * d[1] - s * d[0] - angle_slope * axes[0], d[2]);
  return {rest.axes * glm::transpose(axes) - Mat3d(1.0), rest.slopes * glm::transpose(axes) + rest.axes * glm::transpose(slopes)};
}

CubicStep<Mat3d> hermite(const Rotation& a, const Rotation& b, double h) {
  return CubicStep<Mat3d>::hermite(a.value, h * a.slope, b.value, h * b.slope);
}

/// Sections end at knots and at frames.
std::vector<Section> sections_of(const Spline<Vec3d>& rest, const Roll& roll, const ArcLength& arc) {
  std::vector<double> ends;
  for (int i = 0; i <= rest.pieces(); ++i) ends.push_back(i);
  for (const AxisShape::Frame& f : roll.frames()) ends.push_back(arc.t_at(f.at) * rest.pieces());
  std::sort(ends.begin(), ends.end());
  std::vector<Section> sections;
  for (size_t i = 1; i < ends.size(); ++i) {
    const int piece = std::min(static_cast<int>(0.5 * (ends[i - 1] + ends[i])), rest.pieces() - 1);
    // A shorter one joins its neighbour: a rounding's length off a knot.
    if (ends[i] - ends[i - 1] < 1e-9)
      ends[i] = ends[i - 1];
    else
      sections.push_back({piece, ends[i - 1] - piece, ends[i] - piece});
  }
  return sections;
}

/// Between how many places a cubic step may go: a power of two.
size_t stride_between(const std::vector<Rotation>& rotations) {
  size_t stride = k_places / 2;
  const auto is_precise = [&] {
    for (size_t i = 0; i < k_places; i += stride) {
      const CubicStep<Mat3d> step = hermite(rotations[i], rotations[i + stride], double(stride) / k_places);
      if (!(most_entry(step(0.5) - rotations[i + stride / 2].value) < k_frame_precision)) return false;
    }
    return true;
  };
  while (stride > 2 && !is_precise()) stride /= 2;
  return stride;
}

/// Walks along both axes, section by section.
class StepMaker {
public:
  explicit StepMaker(const AxisShape& shape)
      : rest_(Spline<Vec3d>::b_spline(shape.rest, shape.degree)), deformed_(Spline<Vec3d>::b_spline(shape.deformed, shape.degree)),
        arc_(rest_), roll_(shape, arc_.all()), tangent_(first_tangent(rest_)), normal_(first_normal(shape.normal, tangent_)),
        rest_walk_(tangent_, normal_), deformed_walk_(first_tangent(deformed_), carried(normal_, tangent_, first_tangent(deformed_))) {}

  AxisSteps run() {
    for (const Section& section : sections_of(rest_, roll_, arc_)) add(section);
    out_.at.push_back(1);
    return std::move(out_);
  }

private:
  double length_at(const Section& section, double s) const { return arc_.to(section.place(s) / rest_.pieces()); }

  void add(const Section& section) {
    const CubicStep<Vec3d> rest = part(polynomial(rest_, section.piece), section.from, section.to);
    const CubicStep<Vec3d> deformed = part(polynomial(deformed_, section.piece), section.from, section.to);
    const std::vector<Rotation> rotations = rotations_along(section, rest, deformed);
    const size_t stride = stride_between(rotations);
    for (size_t i = 0; i < k_places; i += stride) {
      const double from = double(i) / k_places, to = double(i + stride) / k_places;
      out_.rest.push_back(part(rest, from, to)), out_.deformed.push_back(part(deformed, from, to));
      AxisTurn turn{{}, hermite(rotations[i], rotations[i + stride], to - from)};
      for (size_t k = 0; k < 4; ++k) turn.shift.a[k] = out_.rest.back().a[k] - out_.deformed.back().a[k];
      out_.turns.push_back(turn);
      out_.at.push_back(length_at(section, from) / std::max(arc_.all(), 1e-300));
    }
    out_.ends.resize(out_.turns.size(), out_.turns.size());
  }

  /// In each of the section's places.
  std::vector<Rotation> rotations_along(const Section& section, const CubicStep<Vec3d>& rest, const CubicStep<Vec3d>& deformed) {
    const double middle = length_at(section, 0.5);
    std::vector<Rotation> rotations;
    for (size_t i = 0; i <= k_places; ++i) {
      const double s = double(i) / k_places;
      const CurveFrame at_rest = rest_walk_.go(rest, s), at = deformed_walk_.go(deformed, s);
      const auto [angle, slope] = roll_.angle(length_at(section, s), middle);
      rotations.push_back(rotation(at_rest, at, angle, slope * glm::length(at_rest.velocity)));
    }
    return rotations;
  }

  Spline<Vec3d> rest_, deformed_;
  ArcLength arc_; ///< of rest_
  Roll roll_;
  Vec3d tangent_, normal_; ///< the first ones of the rest axis
  FrameWalk rest_walk_, deformed_walk_;
  AxisSteps out_;
};

} // namespace

AxisSteps make_steps(const AxisShape& shape) { return StepMaker(shape).run(); }

} // namespace kelpie
