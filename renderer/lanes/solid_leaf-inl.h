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
      return grown(length(to_section({across(p), p.z, hn::Zero(k_lanes)})));
    }
    case SolidLeaf::Form::extruded: break;
    }
    return grown(length(to_section(in_frame(part(), place))));
  }

  /// At a place with a velocity, and on the stretch h either way. To a convex solid the distance along a line is convex: it
  /// lies above its tangent, and below the larger of its ends. From its tangent a ray parts by `drift` times h at most.
  SolidRange range(const V3& place, const V3& velocity, V h, bool wants_most) const {
    const V drift = drift_within(h);
    SolidRange r;
    if (leaf_.form == SolidLeaf::Form::hull) {
      V rate;
      r.distance = hull(place, &velocity, &rate);
      r.set_near(hn::NegMulAdd(drift, h, r.distance), hn::Mul(rate, h));
      if (wants_most) r.far = {distance(at_time(place, velocity, hn::Neg(h))), distance(at_time(place, velocity, h))};
    } else if (leaf_.form == SolidLeaf::Form::extruded) {
      const V3 p = in_frame(part(), place), v = rotated(part(), velocity), to = to_section(p);
      const V d = length(to);
      r.distance = grown(d);
      r.set_near(hn::NegMulAdd(drift, h, r.distance), hn::Mul(divide(dot(to, v), d), h));
      if (wants_most) r.far = {section_distance(at_time(p, v, hn::Neg(h))), section_distance(at_time(p, v, h))};
    } else {
      return turned_range(in_frame(part(), place), rotated(part(), velocity), h, wants_most);
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
    const V3 to = to_section(is_turned ? V3{radius, p.z, hn::Zero(k_lanes)} : p);
    const V3 in_section = is_turned ? V3{outward(p, v, radius), v.z, hn::Zero(k_lanes)} : v;
    const V d = length(to);
    rate = divide(dot(to, in_section), d);
    return grown(d);
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

  V3 to_section(const V3& p) const { return from_nearest(part(), p, leaf_.form == SolidLeaf::Form::extruded); }
  V section_distance(const V3& p) const { return grown(length(to_section(p))); }

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
    return d;
  }

  M is_past_end(const V3& p, V y) const {
    const V side = hn::MulAdd(set(leaf_.past_end_x), p.x, hn::MulAdd(set(leaf_.past_end_y), y, set(leaf_.past_end_0)));
    return hn::Gt(side, hn::Zero(k_lanes));
  }
  V to_arc(const V3& p) const {
    const V y = hn::Abs(p.y);
    const V to_circle = length(to_section({across(p), p.z, hn::Zero(k_lanes)}));
    const V to_end = length({hn::Sub(p.x, set(leaf_.end_x)), hn::Sub(y, set(leaf_.end_y)), p.z});
    return hn::IfThenElse(is_past_end(p, y), to_end, to_circle);
  }

  /// In the half plane through the axis the section is convex, but a line becomes a curve: it lies farther from the axis than
  /// its tangent, by a distance that grows to both sides. Where the solid is convex that is never nearer.
  SolidRange turned_range(const V3& p, const V3& v, V h, bool wants_most) const {
    const V zero = hn::Zero(k_lanes), drift = drift_within(h), radius = across(p);
    const V3 flat{radius, p.z, zero}, flat_v{outward(p, v, radius), v.z, zero}, to = to_section(flat);
    const V d = length(to), back = hn::Neg(h);
    const auto parts_by = [&](V t) { return hn::Sub(across(at_time(p, v, t)), hn::MulAdd(flat_v.x, t, radius)); };
    V bulge = zero;
    if (wants_most || !leaf_.is_convex) bulge = hn::MulAdd(radius, set(1e-6f), hn::Max(hn::Max(parts_by(h), parts_by(back)), zero));
    SolidRange r;
    r.distance = grown(d);
    V middle = hn::NegMulAdd(drift, h, r.distance), rise = hn::Mul(divide(dot(to, flat_v), d), h);
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
      r.far = Line{section_distance(at_time(flat, flat_v, back)), section_distance(at_time(flat, flat_v, h))} + hn::MulAdd(drift, h, bulge);
    }
    return r;
  }

  const Solids& solids_;
  const SolidLeaf& leaf_;
};

/// q^2 (a + b q), q = max(0, 1 - k d^2).
inline V solid_potential(const SolidLeaf& leaf, V distance) {
  const V q = hn::Max(hn::NegMulAdd(set(leaf.k), square_of_positive(distance), set(1)), hn::Zero(k_lanes));
  return hn::Mul(hn::Mul(q, q), hn::MulAdd(set(leaf.b), q, set(leaf.a)));
}

/// As Range's add_leaf, but for one solid.
inline Range solid_range(const Solids& solids, const SolidLeaf& leaf, bool wants_low, bool wants_high, const V3& place, const V3& velocity,
                         V h) {
  const bool is_positive = leaf.a + leaf.b > 0;
  const bool wants_nearest = is_positive ? wants_high : wants_low, wants_farthest = is_positive ? wants_low : wants_high;
  const SolidRange d = SolidView(solids, leaf).range(place, velocity, h, wants_farthest);
  Range r{solid_potential(leaf, d.distance), hn::Zero(k_lanes), hn::Zero(k_lanes)};
  if (wants_nearest) (is_positive ? r.high : r.low) = solid_potential(leaf, d.near.least());
  if (wants_farthest) (is_positive ? r.low : r.high) = solid_potential(leaf, d.far.most());
  return r;
}

/// As Slope's add_leaf, but for one solid.
inline Slope solid_slope(const Solids& solids, const SolidLeaf& leaf, bool wants_low, const V3& place, const V3& velocity, V h) {
  const bool is_positive = leaf.a + leaf.b > 0;
  const SolidRange d = SolidView(solids, leaf).range(place, velocity, h, wants_low || !is_positive);
  const V zero = hn::Zero(k_lanes);
  Slope s{solid_potential(leaf, d.distance), {zero, zero}, {zero, zero}};
  const auto far = [&] { return d.far; };
  add_lines({set(leaf.k), set(leaf.a), set(leaf.b), set(leaf.crest)}, is_positive, wants_low, d.near, far, s);
  return s;
}

} // namespace HWY_NAMESPACE
} // namespace kelpie
HWY_AFTER_NAMESPACE();

#endif
