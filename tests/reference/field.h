// The fields that the reference knows, straight from the formulas (methods.md, sections 1 and 2).
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "tests/reference/axial.h"
#include "tests/reference/metamorphosis.h"

namespace reference {

enum class Falloff {
  quartic,
  cubic,
  wyvill,
  distance ///< linear, in thresholds, from 2 inside the solid to 0 outside
};

/// The coefficients of a cubic B-spline at the places of a lattice: x, then y, then z.
struct Table {
  double step = 1;
  std::array<int, 3> count{};
  std::vector<double> values;
};

/// weight * falloff(d^2 / radius^2), d the distance to a solid.
struct Leaf {
  enum class Shape {
    segment,     ///< from a to b (a = b: a point)
    cone_sphere, ///< the convex hull of the balls of radius r around a and s around b
    disc,        ///< of radius r around a, perpendicular to `normal`
    torus,       ///< the tube of radius s around the circle of radius r around a, perpendicular to `normal`
    arc,         ///< `angle` of the circle of radius r around a, perpendicular to `normal`; its middle is `towards`
    cone,        ///< all discs between that of radius r around a and that of radius s around b
    wall,        ///< the same of circles, thickened across the line from one to the other by r_thickness to s_thickness
    box,         ///< around a, of edges `size` along `towards`, along `normal`, and across both
    hull,        ///< the convex hull of `points`; a is one of them
    // Signed distances, negative inside:
    capsule, ///< all within r of the segment from a to b
    ring,    ///< all within s of the circle of radius r around a, perpendicular to `normal`
    block,   ///< the box, less than `size` by r on all sides, and all within r of it
    rod,     ///< the cylinder of radius r from a to b
    below,   ///< all that lies below the plane through a, perpendicular to `normal`
    table,   ///< the spline of `table`, a is its first place; beyond it, as far as its first value
  };
  Vec a, b;
  double radius = 1, weight = 1;
  Falloff falloff = Falloff::quartic;
  Shape shape = Shape::segment;
  double r = 0, s = 0;
  Vec normal{0, 1, 0};
  Vec towards{1, 0, 0}; ///< what of it is perpendicular to `normal`
  double angle = 0;     ///< in degrees
  double r_thickness = 0, s_thickness = 0;
  Vec size{};
  std::vector<Vec> points{};
  std::shared_ptr<const Table> table{};
};

/// The distance from p to the solid of a leaf; 0 inside, or as its shape says.
double distance(const Leaf&, Vec p);

/// Whether that is less than `reach`, or may be.
bool may_be_within(const Leaf&, Vec p, double reach);

struct Node;
using NodePtr = std::shared_ptr<const Node>;

/// `leaves` stands for their sum; the other kinds have children.
struct Node {
  enum class Kind {
    leaves,
    blend,
    unite,
    intersect,
    subtract,
    warp,
    hyper_blend,
    local_blend,
    mix,
    r_unite,
    r_intersect,
    r_subtract,
    twist,
    bend,
    taper,
    axial
  };
  Kind kind = Kind::leaves;
  std::vector<Leaf> leaves;
  std::vector<NodePtr> children;
  Affine child_from_parent;           ///< of a warp: f(p) = f_child(W^-1 p)
  double n = 1;                       ///< of a hyper-blend
  Vec centre, axis;                   ///< of a twist, a bend or a taper
  double rate = 0;                    ///< of a twist, in degrees a unit
  double length = 0;                  ///< how far along the axis a warp acts; 0, of a twist: everywhere
  Vec towards;                        ///< of a bend: the side of its bend axis, perpendicular to `axis`
  double angle = 0;                   ///< of a bend, in degrees
  double by = 1;                      ///< of a taper: the factor at its end
  std::shared_ptr<const Axial> axial; ///< prepared
  std::shared_ptr<const Mix> mix;     ///< of a metamorphosis, whose children are its elements and then all that its features see
  int material = -1;                  ///< what it and all below it is made of, but for what says otherwise; -1: as what is above
};

/// Where p is for the child of a twist: turned back about the axis.
Vec untwisted(const Node&, Vec p);

/// Where p is for the child of a taper.
Vec untapered(const Node&, Vec p);

/// Where p is for the child of a bend, and how that changes with p.
struct Unbent {
  Vec p;
  double to_axis; ///< the distance from the bend axis, in its radii; infinity of a bend that is straight
  double to_cut;  ///< how far p is from where the map jumps
};
Unbent unbent(const Node&, Vec p);

/// The field f at p; `threshold` is T of the shape, which a difference and R-functions need. The region of a local
/// blend is its last child.
double value(const Node&, Vec p, double threshold);

} // namespace reference
