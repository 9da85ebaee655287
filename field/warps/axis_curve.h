// The axis of a deformation: a curve in cubic steps, the nearest place on it to a point or to all points of a box, and how wide a
// tube around it may be before a point has more than one.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "base/box.h"
#include "base/interval.h"

namespace kelpie {

/// A cubic of s in [0, 1], by coefficients of its powers.
template <class Point>
struct CubicStep {
  std::array<Point, 4> a{};

  Point operator()(double s) const { return a[0] + s * (a[1] + s * (a[2] + s * a[3])); }
  Point first(double s) const { return a[1] + s * (2.0 * a[2] + (3.0 * s) * a[3]); }
  Point second(double s) const { return 2.0 * a[2] + (6.0 * s) * a[3]; }

  /// From values and derivatives at both ends.
  static CubicStep hermite(const Point& p, const Point& dp, const Point& q, const Point& dq) {
    return {{p, dp, 3.0 * (q - p) - 2.0 * dp - dq, 2.0 * (p - q) + dp + dq}};
  }
};

/// The place of an axis that is nearest to a point.
struct AxisFoot {
  size_t step = 0;
  double s = 0;
  Vec3d offset;           ///< from there to the point
  Vec3d first, second;    ///< derivatives of the axis by s
  double distance = 0;    ///< the length of `offset`
  double reach = 0;       ///< the tube's radius there
  bool is_at_end = false; ///< beyond an end of the axis: the place does not change with the point
};

/// A part of a step of an axis.
struct AxisPart {
  size_t step = 0;
  double from = 0, to = 1;    ///< of s
  bool may_be_at_end = false; ///< it holds the nearest place of points beyond an end
};

/// Where the nearest places of all points of a box are that lie in the tube.
struct AxisRange {
  std::vector<AxisPart> parts; ///< none: no point lies in the tube
  bool is_inside = false;      ///< all points lie in the tube, and the parts are connected
  AxisFoot centre;             ///< then, that of the box's centre
};

class AxisCurve {
public:
  /// Steps that join; at least one.
  explicit AxisCurve(std::vector<CubicStep<Vec3d>> steps);

  size_t steps() const { return steps_.size(); }
  const CubicStep<Vec3d>& step(size_t i) const { return steps_[i]; }

  /// At each node (between steps, and at the ends): how wide a tube around the axis may be there. A ball of this radius that
  /// touches the axis there holds no other place of it, so that up to there the place nearest to a point of the normal plane is the
  /// node: neither the bend of the axis nor another part of it comes nearer. From samples, the least of both neighbouring steps.
  std::vector<double> widest_tube() const;

  /// The radius of the tube at each node; between them it is linear. Not wider than `widest_tube`.
  void set_reach(std::vector<double> reach);
  double reach(size_t step, double s) const { return reach_[step] + (reach_[step + 1] - reach_[step]) * s; }
  double reach_slope(size_t step) const { return reach_[step + 1] - reach_[step]; }
  /// Around the tube, and around the part at a step.
  const Box3d& box() const { return box_; }
  const Box3d& box(size_t step) const { return boxes_[step]; }

  /// The place nearest to p; false where p is outside the tube. A nearest node by k-d tree, then Newton's method (Chow & Hui
  /// 2008, section 3.1) within the neighbouring step, in about three steps to the last bit or two. The nodes nearest to the centres
  /// of a lattice are found beforehand: from the node of its cell a point has few steps to go, and a place that is found in the tube
  /// is the nearest one, whatever it was found from. Only where there is none the tree is asked for the point itself.
  bool find(const Vec3d& p, AxisFoot&) const;
  void find(const Box3d&, AxisRange&) const;

private:
  struct Index;
  struct Node {
    Vec3d at, along; ///< along: the derivative by s of the step that begins here, or of the last one
  };
  struct Sphere {
    Vec3d centre;
    double radius;
  };
  /// The node nearest to each cell's centre; k_outside where the cell does not meet the tube.
  struct Lattice {
    static constexpr uint16_t k_outside = 0xffff;
    Vec3d origin, cells_a_unit;
    std::array<int, 3> size{};
    struct Cell {
      uint16_t node = k_outside;
      bool is_single = false; ///< only one short part of the axis has its tube there: what is not found on it is outside
    };
    std::vector<Cell> cells;

    int cell(const Vec3d& p, int axis) const {
      return std::clamp(static_cast<int>((p[axis] - origin[axis]) * cells_a_unit[axis]), 0, size[axis] - 1);
    }
    const Cell& at(const Vec3d& p) const { return cells[static_cast<size_t>((cell(p, 2) * size[1] + cell(p, 1)) * size[0] + cell(p, 0))]; }
  };
  void build_lattice();
  bool find_from(size_t node, const Vec3d& p, AxisFoot&) const;
  bool find_inside(const Box3d&, AxisRange&) const;
  void find_anywhere(const Box3d&, AxisRange&) const;
  bool contract(size_t step, const Box3d&, AxisPart&) const;
  Interval slope_range(size_t step, double s, const Vec3d& centre, const Vec3d& half) const;

  std::vector<CubicStep<Vec3d>> steps_;
  std::vector<std::array<double, 5>> squares_; ///< of each step: (c - c(0)) c' by powers of s, from s on
  std::vector<Node> nodes_;
  std::vector<double> reach_;
  std::vector<Box3d> boxes_, group_boxes_; ///< around the tubes of steps, and of groups of them
  std::vector<Sphere> spheres_;            ///< around steps with their tube
  Box3d box_;
  Lattice lattice_;
  double longest_step_ = 0, most_reach_ = 0;
  std::shared_ptr<const Index> index_;
};

} // namespace kelpie
