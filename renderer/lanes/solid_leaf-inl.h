// The solids of trees in SIMD lanes: skeletons that are no cone-spheres. Lanes are places along a ray, or rays. Included
// once a target.
#if defined(KELPIE_SOLID_LEAF_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef KELPIE_SOLID_LEAF_INL
#undef KELPIE_SOLID_LEAF_INL
#else
#define KELPIE_SOLID_LEAF_INL
#endif

#include "renderer/lanes/tree_leaf-inl.h"

HWY_BEFORE_NAMESPACE();
namespace kelpie {
namespace HWY_NAMESPACE {

inline V clamp(V x, V low, V high) { return hn::Min(hn::Max(x, low), high); }
inline V3 at_time(const V3& p, const V3& v, V t) { return {hn::MulAdd(v.x, t, p.x), hn::MulAdd(v.y, t, p.y), hn::MulAdd(v.z, t, p.z)}; }
inline V length(const V3& a) { return hn::Sqrt(dot(a, a)); }
inline V divide(V a, V length) { return hn::Div(a, hn::Max(length, set(1e-30f))); }

/// The distance to a solid around a place: there, and its bounds on a stretch.
struct SolidRange {
  V distance;
  Line near, far;

  void set_near(V middle, V rise) { near = {hn::Sub(middle, rise), hn::Add(middle, rise)}; }
};

/// A solid seen from places of the lanes in the leaf's base (TreeView::spaces, or the world).
class SolidView {
public:
  SolidView(const Solids& solids, const SolidLeaf& leaf) : solids_(solids), leaf_(leaf) {}

  /// 0 or less inside.
  V distance(const V3& place) const {
    switch (leaf_.form) {
    case SolidLeaf::Form::hull: return hull(place, nullptr, nullptr);
    case SolidLeaf::Form::arc: return to_arc(in_frame(part(), place));
    case SolidLeaf::Form::turned: {
      const V3 p = in_frame(part(), place);
      return from_section({across(p), p.z, hn::Zero(k_lanes)}).distance;
    }
    case SolidLeaf::Form::extruded:
    case SolidLeaf::Form::half_space: break;
    }
    return from_section(in_frame(part(), place)).distance;
  }

  /// At a place with a velocity, and on the stretch h either way. To a convex solid the distance along a line is convex: it
  /// lies above its tangent, and below the larger of its ends. From its tangent a ray parts by `drift` times h at most.
  SolidRange range(const V3& place, const V3& velocity, V h, bool wants_most) const {
    const V drift = drift_within(h);
    SolidRange r;
    switch (leaf_.form) {
    case SolidLeaf::Form::hull: {
      V rate;
      r.distance = hull(place, &velocity, &rate);
      r.set_near(hn::NegMulAdd(drift, h, r.distance), hn::Mul(rate, h));
      if (wants_most) r.far = {distance(at_time(place, velocity, hn::Neg(h))), distance(at_time(place, velocity, h))};
      break;
    }
    case SolidLeaf::Form::extruded:
    case SolidLeaf::Form::half_space: {
      const V3 p = in_frame(part(), place), v = rotated(part(), velocity);
      const FromSection from = from_section(p);
      r.distance = from.distance;
      r.set_near(hn::NegMulAdd(drift, h, r.distance), hn::Mul(from.rate(v), h));
      if (wants_most) r.far = {from_section(at_time(p, v, hn::Neg(h))).distance, from_section(at_time(p, v, h)).distance};
      break;
    }
    case SolidLeaf::Form::turned:
    case SolidLeaf::Form::arc: return turned_range(in_frame(part(), place), rotated(part(), velocity), h, wants_most);
    }
    if (wants_most) r.far = r.far + hn::Mul(drift, h);
    return r;
  }

  /// The distance and, of a convex solid, its derivative at a velocity. Of others a bound of it: the speed.
  V distance(const V3& place, const V3& velocity, V& rate) const {
    if (leaf_.form == SolidLeaf::Form::hull) return hull(place, &velocity, &rate);
    const V3 p = in_frame(part(), place), v = rotated(part(), velocity);
    if (!leaf_.is_convex) {
      rate = length(v);
      return distance(place);
    }
    const bool is_turned = leaf_.form == SolidLeaf::Form::turned;
    const V radius = across(p);
    const FromSection from = from_section(is_turned ? V3{radius, p.z, hn::Zero(k_lanes)} : p);
    rate = from.rate(is_turned ? V3{outward(p, v, radius), v.z, hn::Zero(k_lanes)} : v);
    return from.distance;
  }

private:
  const SolidPart& part(uint32_t i = 0) const { return solids_.parts[leaf_.first_part + i]; }
  V drift_within(V h) const { return hn::Min(set(leaf_.drift), hn::Mul(set(leaf_.bending), h)); }
  V grown(V d) const { return hn::Sub(d, set(leaf_.growth)); }

  static V3 in_frame(const SolidPart& part, const V3& p) {
    return place_in_frame([&](uint32_t r) { return set(part.frame[r]); }, p);
  }
  static V3 rotated(const SolidPart& part, const V3& v) {
    return velocity_in_frame([&](uint32_t r) { return set(part.frame[r]); }, v);
  }

  /// The distance from the axis of what is turned, and its derivative.
  static V across(const V3& p) { return hn::Sqrt(hn::MulAdd(p.x, p.x, hn::Mul(p.y, p.y))); }
  static V outward(const V3& p, const V3& v, V radius) { return divide(hn::MulAdd(p.x, v.x, hn::Mul(p.y, v.y)), radius); }

  /// A place seen from the section, or from what is extruded: its distance, and the direction in which that grows, times `length`.
  struct FromSection {
    V distance;
    V3 direction;
    V length;

    V rate(const V3& v) const { return divide(dot(direction, v), length); }
  };
  FromSection from_section(const V3& p) const {
    const V zero = hn::Zero(k_lanes), one = set(1);
    if (leaf_.form == SolidLeaf::Form::half_space) return {grown(p.z), {zero, zero, one}, one};
    FromSection from;
    from.direction = from_nearest(part(), p, leaf_.form == SolidLeaf::Form::extruded);
    from.length = length(from.direction);
    V distance = from.length;
    if (leaf_.is_signed) go_inside(p, distance, from);
    from.distance = grown(distance);
    return from;
  }
  /// Inside a rectangle the distance is the largest of those to the lines (or planes) of its sides, all of which are below 0 there. On a
  /// side it is 0 from both, but only the side knows the direction.
  void go_inside(const V3& p, V& distance, FromSection& from) const {
    const V zero = hn::Zero(k_lanes);
    V deepest = set(-std::numeric_limits<float>::infinity());
    V3 outward{zero, zero, zero};
    const auto meet = [&](V x, float low, float high, V V3::*axis) {
      const V below = hn::Sub(set(low), x), above = hn::Sub(x, set(high)), side = hn::Max(below, above);
      const M is_nearest = hn::Gt(side, deepest);
      deepest = hn::Max(side, deepest);
      outward = {hn::IfThenZeroElse(is_nearest, outward.x), hn::IfThenZeroElse(is_nearest, outward.y),
                 hn::IfThenZeroElse(is_nearest, outward.z)};
      outward.*axis = hn::IfThenElse(is_nearest, hn::IfThenElse(hn::Gt(below, above), set(-1), set(1)), outward.*axis);
    };
    meet(p.x, part().x_low, part().x_high, &V3::x), meet(p.y, part().y_low, part().y_high, &V3::y);
    if (leaf_.form == SolidLeaf::Form::extruded) meet(p.z, part().z_low, part().z_high, &V3::z);
    const M is_inside = hn::Le(deepest, zero);
    distance = hn::IfThenElse(is_inside, deepest, distance), from.length = hn::IfThenElse(is_inside, set(1), from.length);
    const auto choose = [&](V inside, V outside) { return hn::IfThenElse(is_inside, inside, outside); };
    from.direction = {choose(outward.x, from.direction.x), choose(outward.y, from.direction.y), choose(outward.z, from.direction.z)};
  }

  /// From the nearest point of a part to p.
  V3 from_nearest(const SolidPart& part, const V3& p, bool has_height) const {
    V3 r;
    r.z = has_height ? hn::Sub(p.z, clamp(p.z, set(part.z_low), set(part.z_high))) : hn::Zero(k_lanes);
    if (part.edge_count == 0) {
      r.x = hn::Sub(p.x, clamp(p.x, set(part.x_low), set(part.x_high)));
      r.y = hn::Sub(p.y, clamp(p.y, set(part.y_low), set(part.y_high)));
      return r;
    }
    // As from_nearest() of field/skeletons/convex_polygon.h.
    const V zero = hn::Zero(k_lanes), one = set(1);
    V least = set(std::numeric_limits<float>::infinity());
    r.x = r.y = zero;
    M is_inside = hn::Not(no_lanes()), faces_edge = no_lanes();
    for (uint32_t i = part.first_edge; i < part.first_edge + part.edge_count; ++i) {
      const SolidEdge& e = solids_.edges[i];
      const V x = hn::Sub(p.x, set(e.x)), y = hn::Sub(p.y, set(e.y)), ex = set(e.along_x), ey = set(e.along_y);
      const V s = hn::Mul(hn::MulAdd(x, ex, hn::Mul(y, ey)), set(e.inverse_square)), on_edge = clamp(s, zero, one);
      const V rx = hn::NegMulAdd(on_edge, ex, x), ry = hn::NegMulAdd(on_edge, ey, y);
      const V squared = hn::MulAdd(rx, rx, hn::Mul(ry, ry));
      is_inside = hn::And(is_inside, hn::Ge(hn::Mul(ex, y), hn::Mul(ey, x)));
      const M is_nearer = hn::Lt(squared, least), is_between = hn::And(hn::Gt(s, zero), hn::Lt(s, one));
      faces_edge = hn::Or(hn::And(is_nearer, is_between), hn::AndNot(is_nearer, faces_edge));
      least = hn::IfThenElse(is_nearer, squared, least);
      r.x = hn::IfThenElse(is_nearer, rx, r.x), r.y = hn::IfThenElse(is_nearer, ry, r.y);
    }
    const M is_over = hn::And(is_inside, faces_edge);
    r.x = hn::IfThenZeroElse(is_over, r.x), r.y = hn::IfThenZeroElse(is_over, r.y);
    return r;
  }

  /// To the nearest face, or 0 inside: outside all faces the nearest point is never inside one. `rate`: by the velocity.
  V hull(const V3& place, const V3* velocity, V* rate) const {
    const V zero = hn::Zero(k_lanes);
    V least = set(std::numeric_limits<float>::infinity()), along = zero;
    M is_inside = hn::Not(no_lanes()), is_over = no_lanes();
    for (uint32_t i = 0; i < leaf_.part_count; ++i) {
      const V3 p = in_frame(part(i), place), r = from_nearest(part(i), p, true);
      const V squared = dot(r, r);
      const M is_nearer = hn::Lt(squared, least), is_over_this = hn::And(hn::Eq(r.x, zero), hn::Eq(r.y, zero));
      is_inside = hn::And(is_inside, hn::Le(p.z, zero));
      is_over = hn::Or(hn::And(is_nearer, is_over_this), hn::AndNot(is_nearer, is_over));
      least = hn::IfThenElse(is_nearer, squared, least);
      if (velocity) along = hn::IfThenElse(is_nearer, dot(r, rotated(part(i), *velocity)), along);
    }
    const M within = hn::And(is_inside, is_over);
    const V d = hn::IfThenZeroElse(within, hn::Sqrt(least));
    if (rate) *rate = hn::IfThenZeroElse(within, divide(along, d));
    return grown(d);
  }

  M is_past_end(const V3& p, V y) const {
    const V side = hn::MulAdd(set(leaf_.past_end_x), p.x, hn::MulAdd(set(leaf_.past_end_y), y, set(leaf_.past_end_0)));
    return hn::Gt(side, hn::Zero(k_lanes));
  }
  V to_arc(const V3& p) const {
    const V y = hn::Abs(p.y);
    const V to_circle = from_section({across(p), p.z, hn::Zero(k_lanes)}).distance;
    const V to_end = length({hn::Sub(p.x, set(leaf_.end_x)), hn::Sub(y, set(leaf_.end_y)), p.z});
    return hn::IfThenElse(is_past_end(p, y), grown(to_end), to_circle);
  }

  /// In the half plane through the axis the section is convex, but a line becomes a curve: it lies farther from the axis than
  /// its tangent, by a distance that grows to both sides. Where the solid is convex that is never nearer.
  SolidRange turned_range(const V3& p, const V3& v, V h, bool wants_most) const {
    const V zero = hn::Zero(k_lanes), drift = drift_within(h), radius = across(p);
    const V3 flat{radius, p.z, zero}, flat_v{outward(p, v, radius), v.z, zero};
    const FromSection from = from_section(flat);
    const V back = hn::Neg(h);
    const auto parts_by = [&](V t) { return hn::Sub(across(at_time(p, v, t)), hn::MulAdd(flat_v.x, t, radius)); };
    V bulge = zero;
    if (wants_most || !leaf_.is_convex) bulge = hn::MulAdd(radius, set(1e-6f), hn::Max(hn::Max(parts_by(h), parts_by(back)), zero));
    SolidRange r;
    r.distance = from.distance;
    V middle = hn::NegMulAdd(drift, h, r.distance), rise = hn::Mul(from.rate(flat_v), h);
    if (!leaf_.is_convex) {
      const V farthest = hn::Mul(hn::Add(length(v), drift), h);
      if (leaf_.form == SolidLeaf::Form::arc) r.distance = to_arc(p); // it is part of the circle: not nearer than that
      middle = hn::Sub(middle, bulge);
      const V by_speed = hn::Sub(r.distance, farthest);
      const M is_far = hn::Gt(by_speed, hn::Sub(middle, hn::Abs(rise)));
      middle = hn::IfThenElse(is_far, by_speed, middle), rise = hn::IfThenZeroElse(is_far, rise);
    }
    r.set_near(middle, rise);
    if (!leaf_.is_convex) {
      const V farthest = hn::Mul(hn::Add(length(v), drift), h);
      if (leaf_.form == SolidLeaf::Form::arc) {
        r.far = {hn::Add(r.distance, farthest), hn::Add(r.distance, farthest)};
        return r;
      }
    }
    if (wants_most) {
      r.far = Line{from_section(at_time(flat, flat_v, back)).distance, from_section(at_time(flat, flat_v, h)).distance} +
              hn::MulAdd(drift, h, bulge);
    }
    return r;
  }

  const Solids& solids_;
  const SolidLeaf& leaf_;
};

inline Bump bump_of(const SolidPotential& p) { return {set(p.k), set(p.a), set(p.b), set(p.crest)}; }
inline Ramp ramp_of(const SolidPotential& p) { return {set(p.a), set(p.b), set(p.low), set(p.high)}; }

inline V solid_potential(const SolidLeaf& leaf, V distance) {
  const SolidPotential& p = leaf.potential;
  if (p.form == SolidPotential::Form::ramp) return ramp_of(p).at(distance);
  const Bump bump = bump_of(p);
  return bump.at(bump.closeness(distance));
}

/// As add_leaf, but for one solid.
inline Slope solid_slope(const Solids& solids, const SolidLeaf& leaf, bool wants_low, const V3& place, const V3& velocity, V h) {
  const SolidPotential& potential = leaf.potential;
  const bool is_positive = potential.is_positive();
  const SolidRange d = SolidView(solids, leaf).range(place, velocity, h, wants_low || !is_positive);
  const V zero = hn::Zero(k_lanes);
  Slope s{solid_potential(leaf, d.distance), {zero, zero}, {zero, zero}};
  const auto far = [&] { return d.far; };
  if (potential.form == SolidPotential::Form::ramp)
    add_lines(ramp_of(potential), is_positive, wants_low, d.near, far, s);
  else
    add_lines(bump_of(potential), is_positive, wants_low, d.near, far, s);
  return s;
}

} // namespace HWY_NAMESPACE
} // namespace kelpie
HWY_AFTER_NAMESPACE();

#endif
