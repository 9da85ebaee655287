// One axis of a deformation: a rest axis, a deformed axis, frames along both, and the tube of space that goes with them.
#pragma once

#include "field/warps/axis_steps.h"

namespace kelpie {

/// What an axis makes of a point, or of all points of a box (T: double or Interval): the rest point is p + by.
template <class T>
struct AxisOffer {
  using Slopes = std::array<T, 3>;
  std::array<T, 3> by{};
  std::array<Slopes, 3> by_slopes{};
  T depth{};             ///< 1 on the axis, 0 on the surface of the tube and outside
  Slopes depth_slopes{}; ///< by the point's coordinates
  T limit{};             ///< what differs by more than this from `by` cannot be joined to it by the border
  Slopes limit_slopes{};
  double border = 1; ///< the depth at its end
};

/// An axis as it acts on the points of a box, in a section between knots and frames: polynomials of u, the place on the axis less
/// that where u is 0, in no unit. The place c(u) that is nearest to p = middle + d is where (offset + d - dc(u)) c'(u) = 0, but for
/// the limits, and the rest point is p + shift(u) + turn(u) (offset + d - dc(u)).
struct AxisPiece {
  double low, high;           ///< limits: the ends of the axis, or where no point of the box has its place
  double joint;               ///< the end of the section: another may follow, which has the places beyond
  Vec3d offset;               ///< from c(0) to the middle of the box
  std::array<Vec3d, 3> axis;  ///< dc(u) = c(u) - c(0), by powers of u, from the first on
  std::array<Vec3d, 4> shift; ///< by powers of u
  std::array<Mat3d, 5> turn;  ///< by powers of u
  int newton_steps;           ///< so many from u = 0 find the place of every point of the box, to 1e-6 of what is in question
};

class AxisTube {
public:
  explicit AxisTube(const AxisShape&);

  /// Whether it moves anything.
  bool moves() const { return moves_; }
  /// The place on the rest axis, as a part of its length, where the tube is cut the most, and its radius there; that of the shape
  /// where it is not cut.
  double cut_at() const { return cut_at_; }
  double cut_radius() const { return cut_radius_; }

  const AxisCurve& deformed() const { return deformed_; }
  const AxisCurve& rest() const { return rest_; }

  /// For a point of the deformed space; false if it is outside the tube. Slopes only if they are asked for.
  bool offer(const Vec3d& p, bool with_slopes, AxisOffer<double>&) const;
  /// For a box: `contains`, in each offer, whatever any point of it is offered; depth 0 where it is outside. False: all are.
  bool offer(const Box3d&, AxisOffer<Interval>&) const;

  /// The axis as it acts on a box that lies in the tube: one piece for each section, in order; a place beyond the end of one is in the
  /// next. False if it is not to be had so that rest points differ from those of offer() by no more than `tolerance`, or what frames are
  /// precise to.
  bool pieces(const Box3d&, double tolerance, std::vector<AxisPiece>&) const;

  /// For a point of the rest space: how far it is moved; false if it is outside the tube.
  bool move(const Vec3d& q, Vec3d& by, double& limit) const;
  /// Whether any point of a box of the rest space is moved by more than the limit, and whether all are.
  struct Moved {
    bool some = false, all = false;
  };
  Moved moved(const Box3d&) const;

  /// Grows `image` by all points of the deformed space that may be offered a place in `rest`.
  void extend_image(const Box3d& rest, Box3d& image) const;
  double most_limit() const { return most_reach_ * limit_part_; }

private:
  AxisTube(const AxisShape&, AxisSteps&&);
  void offer_at(const AxisFoot&, bool with_slopes, AxisOffer<double>&) const;
  void offer_part(const AxisPart&, const Box3d&, Interval distance, AxisOffer<Interval>&) const;
  bool fit(size_t step, double from, double to, const Box3d&, double tolerance, AxisPiece&) const;

  AxisCurve deformed_, rest_;
  std::vector<AxisTurn> turns_;
  std::vector<size_t> ends_; ///< of each step: that after the last step of its section, between knots and frames
  double border_, limit_part_, most_reach_ = 0;
  double cut_at_ = 0, cut_radius_ = 0;
  bool moves_ = false;
};

} // namespace kelpie
