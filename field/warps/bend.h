#pragma once

#include <limits>
#include <numbers>

#include "base/box.h"
#include "field/skeletons/frame.h"
#include "field/warps/warp_way.h"

namespace kelpie {

/// The angle of the vector (x, y), in [least, least + 2 pi).
inline double azimuth(double x, double y, double least) {
  const double angle = std::atan2(y, x);
  return angle < least ? angle + 2 * std::numbers::pi : angle >= least + 2 * std::numbers::pi ? angle - 2 * std::numbers::pi : angle;
}
/// Exact: over a box that keeps off the origin and off the cut the extremes are at corners. Any other box is
/// given the whole circle, by which a jump is known.
inline Interval azimuth(Interval x, Interval y, double least) {
  const Interval everywhere{least, least + 2 * std::numbers::pi};
  if (x.contains(0) && y.contains(0)) return everywhere;
  const double a = azimuth(x.lo, y.lo, least), b = azimuth(x.lo, y.hi, least), c = azimuth(x.hi, y.lo, least),
               d = azimuth(x.hi, y.hi, least);
  const Interval range{std::min(std::min(a, b), std::min(c, d)), std::max(std::max(a, b), std::max(c, d))};
  return range.width() < std::numbers::pi ? range : everywhere;
}
/// The slopes of a jump: finite, so that products with 0 stay numbers.
inline constexpr Interval k_jump{-1e30, 1e30};
inline double azimuth_slope(double cosine, double radius, double) { return radius > 0 ? cosine / radius : 0; }
inline Interval azimuth_slope(Interval cosine, Interval radius, Interval angle) {
  return angle.width() < std::numbers::pi ? intersect(cosine / radius, k_jump) : k_jump;
}
template <class T, int N>
Dual<T, N> azimuth(const Dual<T, N>& x, const Dual<T, N>& y, double least) {
  Dual<T, N> r;
  r.value = azimuth(x.value, y.value, least);
  const T radius = norm(x.value, y.value);
  const T by_x = -azimuth_slope(cosine(y.value, x.value), radius, r.value), by_y = azimuth_slope(cosine(x.value, y.value), radius, r.value);
  for (int i = 0; i < N; ++i) r.d[i] = by_x * x.d[i] + by_y * y.d[i];
  return r;
}

template <class Mode>
struct Bend {
  static constexpr std::string_view k_name = "bend";
  static constexpr std::string_view k_doc = R"(Bends its child along an arc of a circle: a straight rod becomes a hook or a ring.

    f(p) = f_child(W^-1 p),   W turns what lies at height h above `centre`, h in [0, length], by angle * h / length
                              about the bend axis, after it has been moved back to height 0

The bend axis lies at distance `length` / angle (in radians) from the line through `centre` along `axis`, on the side
of `towards`, perpendicular to both. The line itself keeps its length. Before `centre` nothing moves; what is beyond
`length` goes on straight. At distance d from the bend axis lengths along the arc change by the factor d * angle / length.
A negative `angle` bends the other way.

The child should end before the bend axis. Points past it, on the far side of the arc, are seen by whichever straight
part is nearer: where the two meet, opposite the middle of the arc, what the child has there is cut off.
Source: Barr 1984, "Global and local deformations of solid primitives"; methods.md section 2, warps.)";

  Value<Mode, Vec3> axis{Vec3(0, 1, 0)};
  Value<Mode, Vec3> towards{Vec3(1, 0, 0)};
  Value<Mode, Vec3> centre{Vec3(0)};
  Value<Mode, float> angle{90.f};
  Value<Mode, float> length{1.f};
  typename Mode::Child child{};

  static constexpr auto parameters() {
    return std::tuple{
        parameter("axis", &Bend::axis, "direction of the line that is bent; need not be a unit vector").nonzero(),
        parameter("towards", &Bend::towards, "the side to which it is bent; only what is perpendicular to `axis` counts").nonzero(),
        parameter("centre", &Bend::centre, "where on the line the bend begins").in(Unit::length),
        parameter("angle", &Bend::angle, "from the bend's beginning to its end").in(Unit::degrees).at_least(-360).at_most(360).required(),
        parameter("length", &Bend::length, "how far along the line it is bent").in(Unit::length).above(0).required(),
        parameter("child", &Bend::child, "the field to bend").required(),
    };
  }

  // Sampled:

  template <class Real>
  Point3<Real> child_from_parent(const Point3<Real>& p) const {
    const Arc arc(*this);
    if (arc.is_straight()) return p;
    const Turned<Real> q(arc, p);
    const Real turn = azimuth(q.x, q.y, arc.cut);
    Pieces<Real> pieces;
    for_each_piece(arc, q, turn, [&](const Point3<Real>& piece) { pieces.add(piece); });
    if (range_of(turn).width() >= std::numbers::pi) pieces.tear();
    return arc.frame.global(pieces.all);
  }

  /// Whether the box meets the cut or the bend axis; then boxes around its images: one for each part of space on either side.
  bool torn_images(const Box3d& box, std::vector<Box3d>& images) const {
    constexpr double whole = 2 * std::numbers::pi;
    const Arc arc(*this);
    if (arc.is_straight()) return false;
    const Turned<Interval> q(arc, {{box.lower.x, box.upper.x}, {box.lower.y, box.upper.y}, {box.lower.z, box.upper.z}});
    const Interval turn = azimuth(q.x, q.y, arc.cut);
    if (turn.width() < std::numbers::pi) return false;
    images.clear();
    const auto add = [&](const Point3<Interval>& piece) {
      const Point3<Interval> p = arc.frame.global(piece);
      images.push_back({{p.x.lo, p.y.lo, p.z.lo}, {p.x.hi, p.y.hi, p.z.hi}});
    };
    const Interval across = azimuth(q.x, q.y, arc.cut + std::numbers::pi); // no jump where the cut is
    if (across.width() >= std::numbers::pi) {                              // the bend axis
      for_each_piece(arc, q, turn, add);
      return true;
    }
    for_each_piece(arc, q, Interval{across.lo, arc.cut + whole}, add);
    for_each_piece(arc, q, Interval{arc.cut, across.hi - whole}, add);
    return true;
  }

  /// Half the largest second derivative of child_from_parent in a box, in any direction; infinite across a kink or the cut.
  double most_bending(const Point3<Interval>& p) const {
    const Arc arc(*this);
    if (arc.is_straight()) return 0;
    const Turned<Interval> q(arc, p);
    const Interval turn = azimuth(q.x, q.y, arc.cut);
    if (turn.width() >= std::numbers::pi) return std::numeric_limits<double>::infinity();
    if (turn.hi < 0 || turn.lo > arc.end) return 0;
    if (turn.lo < 0 || turn.hi > arc.end) return std::numeric_limits<double>::infinity();
    // Of the distance d from the bend axis, in radii, 1 / d; of the angle 1 / d^2.
    const double nearest = norm(q.x, q.y).lo;
    return 0.5 * arc.curvature * norm(1 / nearest, 1 / square(nearest));
  }

  template <class Real>
  Point3<Real> parent_from_child(const Point3<Real>& p) const {
    const Arc arc(*this);
    if (arc.is_straight()) return p;
    const Point3<Real> q = arc.frame.local(p);
    const double k = arc.curvature;
    const Interval range = range_of(q.z);
    Pieces<Real> pieces;
    if (range.lo <= 0) pieces.add({q.x, q.y, within(q.z, {-k_far, 0})});
    if (range.hi >= 0 && range.lo <= length) {
      const Real turn = k * within(q.z, {0, length}), radius = Real(1.0) - k * q.x;
      pieces.add({(Real(1.0) - radius * cos(turn)) * (1 / k), q.y, radius * sin(turn) * (1 / k)});
    }
    if (range.hi >= length) pieces.add(arc.beyond_end(Point3<Real>{q.x, q.y, within(q.z, {length, k_far})}));
    return arc.frame.global(pieces.all);
  }

  /// A box around the image of a box.
  Box3d image_of(const Box3d& box) const {
    const Point3<Interval> r =
        parent_from_child(Point3<Interval>{{box.lower.x, box.upper.x}, {box.lower.y, box.upper.y}, {box.lower.z, box.upper.z}});
    return {Vec3d(r.x.lo, r.y.lo, r.z.lo), Vec3d(r.x.hi, r.y.hi, r.z.hi)};
  }

  /// How far apart two states, and any two states interpolated between them, take a point of a box. In the frame's coordinates, with
  /// t = angle * clamp(z / length, 0, 1) signed: a child's point (x, y, z) goes to c(z) + x n(t), c the integral of the unit vector at
  /// t, so when t changes by dt it moves by no more than dt (max(0, z) + |x|). A place that stays comes from a child's point that moves
  /// as far, but along the line by 1 / (k d) as far within the arc, d the distance from the bend axis. Across the cut the child's
  /// x is the same, z is any.
  Vec3d displacement_from(const Bend& other, const Box3d& box, WarpWay way) const {
    const AxisFrame a{Vec3d(centre), Vec3d(axis), Vec3d(towards)}, b{Vec3d(other.centre), Vec3d(other.axis), Vec3d(other.towards)};
    const FrameTurn frame_turn = turn_of(Vec3d(axis), Vec3d(towards), Vec3d(other.axis), Vec3d(other.towards));
    const double turn = std::min(2.0, frame_turn.axis + frame_turn.about), shift = glm::distance(a.origin, b.origin);
    double reach = 0;
    for (const Vec3d& from : {a.origin, b.origin})
      reach = std::max(reach, glm::length(glm::max(glm::abs(box.lower - from), glm::abs(box.upper - from))));
    const Point3<Interval> in_box{{box.lower.x, box.upper.x}, {box.lower.y, box.upper.y}, {box.lower.z, box.upper.z}};
    const double slid = shift + turn * reach; // how far coordinates in the frame change
    const Point3<Interval> p = a.local(in_box);
    const Interval x = p.x + Interval{-slid, slid}, z = p.z + Interval{-slid, slid};

    const Interval angles = hull(glm::radians(double(angle)), glm::radians(double(other.angle)));
    const double shortest = std::min(length, other.length), longest = std::max(length, other.length), most_angle = angles.magnitude();
    const double opened = angles.width() + most_angle * (longest - shortest) / shortest; // how much t changes where z >= length
    const auto part = [&](double to) { return std::min(1.0, std::max(0.0, to) / shortest); };
    if (way == WarpWay::to_parent) {
      const double top = part(z.hi), far = std::max(0.0, z.hi) + x.magnitude(), stretch = most_angle / shortest * x.magnitude();
      const double bent = std::min(2.0, most_angle * top);
      return Vec3d(opened * top * far + bent * turn * far + (bent + stretch) * slid);
    }

    // Of any state, the bend axis is at (1, 0) and the cut goes from there to the left, turned by half of the angle.
    const Interval k = hull(glm::radians(double(angle)) / double(length), glm::radians(double(other.angle)) / double(other.length)),
                   one(1.0);
    const Interval from_axis = one - k * x, along = k * z, c = cos(0.5 * angles), s = sin(0.5 * angles);
    const bool is_cut = (c * from_axis + s * along).lo <= 0 && (c * along - s * from_axis).contains(0);
    const double least = std::min(1.0, norm(from_axis, along).lo), everywhere = 2 * (reach + 2 * longest);

    const Point3<Interval> q = a.local(child_from_parent(in_box));
    double far = 3 * longest + 2 * reach, top = 1; // the farthest max(0, z) + |x| of any state, and the part of the angle there
    Vec3d moved(0);
    for (int i = 0; i < 2; ++i) { // what is known of this state limits the others
      moved.x = opened * top * far + 2 * slid;
      moved.z = is_cut || !(least > 0) ? everywhere : std::min(everywhere, opened * top * far / least + (1 + 1 / least) * slid);
      far = std::min(far, std::max(0.0, q.z.hi) + moved.z + q.x.magnitude() + moved.x), top = part(q.z.hi + moved.z);
    }
    moved.y = 0;
    moved += turn * (reach + far + glm::length(moved));
    return glm::abs(a.u) * moved.x + glm::abs(a.v) * moved.y + glm::abs(a.e) * moved.z;
  }

  /// In the frame: x towards the bend axis, z along the line.
  struct Arc {
    AxisFrame frame;
    double end, curvature; ///< the whole angle and that for a unit of length, in radians, not negative
    double cut;            ///< the angle at which space is cut: opposite the middle of the arc
    double c, s, x, z;     ///< cosine and sine of `end`; what is beyond the end was turned by it and then moved by (x, 0, z)

    explicit Arc(const Bend& b)
        : frame(Vec3d(b.centre), Vec3d(b.axis), b.angle < 0 ? -Vec3d(b.towards) : Vec3d(b.towards)),
          end(glm::radians(std::abs(double(b.angle)))), curvature(end / double(b.length)), cut(0.5 * end - std::numbers::pi),
          c(std::cos(end)), s(std::sin(end)), x((1 - c) / curvature), z((end - s) / curvature) {}

    /// Below this angle rounding would move points by more than the bend does: both are about 1e-8 of the length.
    bool is_straight() const { return end < 1e-8; }

    template <class Real>
    Point3<Real> before_end(const Point3<Real>& q) const {
      return {q.x * c - q.z * s + Real(x), q.y, q.x * s + q.z * c + Real(z)};
    }
    template <class Real>
    Point3<Real> beyond_end(const Point3<Real>& q) const {
      const Real a = q.x - Real(x), h = q.z - Real(z);
      return {a * c + h * s, q.y, h * c - a * s};
    }
  };

private:
  static constexpr double k_far = std::numeric_limits<double>::infinity();

  /// A point in the frame of the arc, and about the bend axis in radii: there the line is at 1.
  template <class Real>
  struct Turned {
    Point3<Real> at;
    Real x, y;
    Turned(const Arc& arc, const Point3<Real>& p) : at(arc.frame.local(p)), x(Real(1.0) - arc.curvature * at.x), y(arc.curvature * at.z) {}
  };

  /// Where each part of space that is met at an angle of `turn` comes from, in the frame.
  template <class Real, class Visit>
  void for_each_piece(const Arc& arc, const Turned<Real>& q, const Real& turn, Visit&& visit) const {
    const Interval range = range_of(turn);
    if (range.lo <= 0) visit(Point3<Real>{q.at.x, q.at.y, within(q.at.z, {-k_far, 0})});
    if (range.hi >= 0 && range.lo <= arc.end) {
      const double radius = 1 / arc.curvature;
      visit(Point3<Real>{(Real(1.0) - norm(q.x, q.y)) * radius, q.at.y, within(turn * radius, {0, length})});
    }
    if (range.hi >= arc.end) {
      const Point3<Real> r = arc.before_end(q.at);
      visit(Point3<Real>{r.x, r.y, within(r.z, {length, k_far})});
    }
  }

  /// What holds in any of the parts of space that a box meets.
  template <class Real>
  struct Pieces {
    Point3<Real> all{};
    bool is_first = true;

    void add(const Point3<Real>& p) {
      all = is_first ? p : Point3<Real>{either(all.x, p.x), either(all.y, p.y), either(all.z, p.z)};
      is_first = false;
    }
    /// The box meets the cut: differences have no bound.
    void tear() {
      if constexpr (requires { all.x.d[0].lo; })
        for (Real* r : {&all.x, &all.y, &all.z}) r->d.fill(k_jump);
    }
  };
};

} // namespace kelpie
