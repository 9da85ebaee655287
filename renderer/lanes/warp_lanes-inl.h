// Warps in SIMD lanes: places and velocities in warped spaces. Included once a target.
#if defined(KELPIE_WARP_LANES_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef KELPIE_WARP_LANES_INL
#undef KELPIE_WARP_LANES_INL
#else
#define KELPIE_WARP_LANES_INL
#endif

#include <hwy/contrib/math/math-inl.h>

#include "field/warps/axis_work.h"
#include "renderer/lanes/lanes-inl.h"
#include "renderer/lanes/tree_view.h"

HWY_BEFORE_NAMESPACE();
namespace kelpie {
namespace HWY_NAMESPACE {

/// Places and velocities of the lanes.
struct Curve {
  V3 place, velocity;
};

inline V3 times(const float* rows, const V3& p) {
  const auto row = [&](int i) { return dot({set(rows[i]), set(rows[i + 1]), set(rows[i + 2])}, p); };
  return {row(0), row(3), row(6)};
}

/// The height that acts, less that of the centre, and its derivative.
inline V acting(const LaneWarp& w, V height, V& rate) {
  const V h = hn::Add(height, set(w.ahead)), low = set(w.low), high = set(w.high);
  rate = hn::IfThenElseZero(hn::And(hn::Ge(h, low), hn::Le(h, high)), rate);
  return hn::Min(hn::Max(h, low), high);
}

/// Turned by a more than the centre is: cos a - 1 = -2 sin^2(a/2) keeps the digits of small angles.
inline Curve twisted(const LaneWarp& w, const V3& d, const V3& v) {
  V turning = v.z;
  const V half = hn::Mul(set(0.5f * w.rate), acting(w, d.z, turning));
  turning = hn::Mul(turning, set(w.rate));
  const V sine_half = hn::Sin(k_lanes, half), cosine_half = hn::Cos(k_lanes, half);
  const V sine = hn::Mul(hn::Add(sine_half, sine_half), cosine_half), less = hn::Mul(hn::Mul(set(-2), sine_half), sine_half);
  const V cosine = hn::Add(less, set(1));
  const V x = hn::Add(d.x, set(w.x)), y = hn::Add(d.y, set(w.y));
  const V rx = hn::NegMulAdd(sine, y, hn::Mul(cosine, x)), ry = hn::MulAdd(sine, x, hn::Mul(cosine, y));
  return {{hn::MulAdd(less, x, hn::NegMulAdd(sine, y, d.x)), hn::MulAdd(less, y, hn::MulAdd(sine, x, d.y)), d.z},
          {hn::NegMulAdd(turning, ry, hn::NegMulAdd(sine, v.y, hn::Mul(cosine, v.x))),
           hn::MulAdd(turning, rx, hn::MulAdd(sine, v.x, hn::Mul(cosine, v.y))), v.z}};
}

/// x / s - c / s_c = (d - c (s - s_c) / s_c) / s.
inline Curve tapered(const LaneWarp& w, const V3& d, const V3& v) {
  V rate = v.z;
  const V change = hn::Mul(set(w.rate), acting(w, d.z, rate)), inverse = hn::Div(set(1), hn::Add(set(w.factor), change));
  rate = hn::Mul(rate, set(w.rate));
  const V relative = hn::Mul(change, set(1 / w.factor));
  const auto place = [&](V dx, float x) { return hn::Mul(hn::NegMulAdd(set(x), relative, dx), inverse); };
  const auto velocity = [&](V dx, float x, V vx) {
    return hn::Mul(hn::NegMulAdd(hn::Mul(hn::Add(dx, set(x)), inverse), rate, vx), inverse);
  };
  return {{place(d.x, w.x), place(d.y, w.y), d.z}, {velocity(d.x, w.x, v.x), velocity(d.y, w.y, v.y), v.z}};
}

/// With (u, w) from the bend axis, across and along, the arc's coordinates are line - |(u, w)| and line times the angle. Of both
/// the differences from the centre's: |a| - |b| = (a - b)(a + b) / (|a| + |b|), and the angle between a and b.
inline Curve bent(const LaneWarp& w, const V3& d, const V3& v) {
  const V zero = hn::Zero(k_lanes), u0 = set(w.across), w0 = set(w.along), du = hn::Neg(d.x), dw = d.z;
  const V u = hn::Add(u0, du), along = hn::Add(w0, dw), squared = hn::Max(hn::MulAdd(u, u, hn::Mul(along, along)), set(1e-30f));
  const V distance = hn::Sqrt(squared);
  const V nearer = hn::Div(hn::MulAdd(du, hn::Add(u, u0), hn::Mul(dw, hn::Add(along, w0))), hn::Add(distance, set(w.distance)));
  const V sine = hn::NegMulAdd(w0, du, hn::Mul(u0, dw)), cosine = hn::MulAdd(u0, u, hn::Mul(w0, along));
  const V half_turn = hn::IfThenElseZero(hn::Lt(cosine, zero), hn::CopySign(set(3.14159265f), sine));
  const V tiny = set(1e-30f), safe = hn::IfThenElse(hn::Lt(hn::Abs(cosine), tiny), tiny, cosine);
  const V angle = hn::Add(hn::Atan(k_lanes, hn::Div(sine, safe)), half_turn), turn = hn::Add(angle, set(w.angle));
  const V line = set(w.line), vu = hn::Neg(v.x), vw = v.z;
  const Curve in_arc{{hn::Neg(nearer), d.y, hn::Mul(line, angle)},
                     {hn::Neg(hn::Div(hn::MulAdd(u, vu, hn::Mul(along, vw)), distance)), v.y,
                      hn::Div(hn::Mul(line, hn::NegMulAdd(along, vu, hn::Mul(u, vw))), squared)}};
  const V c = set(w.cosine), s = set(w.sine);
  const auto beyond = [&](const V3& p) { return V3{hn::NegMulAdd(p.z, s, hn::Mul(p.x, c)), p.y, hn::MulAdd(p.x, s, hn::Mul(p.z, c))}; };
  const V3 d_beyond = beyond(d), v_beyond = beyond(v);
  const M is_before = hn::Le(turn, zero), is_beyond = hn::Gt(turn, set(w.end));
  const auto choose = [&](V before, V arc, V after) { return hn::IfThenElse(is_before, before, hn::IfThenElse(is_beyond, after, arc)); };
  const auto moved = [&](V before, V arc, V after, const float* offsets) {
    return choose(hn::Add(before, set(offsets[0])), hn::Add(arc, set(offsets[1])), hn::Add(after, set(offsets[2])));
  };
  return {{moved(d.x, in_arc.place.x, d_beyond.x, w.offset_x), d.y, moved(d.z, in_arc.place.z, d_beyond.z, w.offset_z)},
          {choose(v.x, in_arc.velocity.x, v_beyond.x), v.y, choose(v.z, in_arc.velocity.z, v_beyond.z)}};
}

/// A polynomial of u: first + u (numbers[0] + u (numbers[stride] + ...)), of so many powers.
template <size_t Powers>
V polynomial(const float* numbers, size_t stride, V u, V first) {
  V sum = set(numbers[(Powers - 1) * stride]);
  for (size_t i = Powers - 1; i-- > 0;) sum = hn::MulAdd(sum, u, set(numbers[i * stride]));
  return hn::MulAdd(sum, u, first);
}
/// Its derivative.
template <size_t Powers>
V derivative(const float* numbers, size_t stride, V u) {
  V sum = set(float(Powers) * numbers[(Powers - 1) * stride]);
  for (size_t i = Powers - 1; i-- > 0;) sum = hn::MulAdd(sum, u, set(float(i + 1) * numbers[i * stride]));
  return sum;
}

/// As AxisPiece says; `beyond`: which lanes have their place in the next piece.
static HWY_NOINLINE Curve along_axis(const LaneAxis& a, const V3& d, const V3& v, M& beyond) {
  const auto vector = [](const float* p) { return V3{set(p[0]), set(p[1]), set(p[2])}; };
  const V zero = hn::Zero(k_lanes);
  const V3 w{hn::Add(d.x, set(a.offset[0])), hn::Add(d.y, set(a.offset[1])), hn::Add(d.z, set(a.offset[2]))};
  // f = (w - dc) c', which falls with u, by powers of u.
  const V3 first = vector(a.axis[0]);
  const V f0 = hn::Add(dot(first, d), set(a.along));
  const V f1 = hn::MulSub(set(2), dot(vector(a.axis[1]), w), set(a.squares[0]));
  const V f2 = hn::MulSub(set(3), dot(vector(a.axis[2]), w), set(a.squares[1]));
  const auto f = [&](V u) {
    const V high = hn::MulAdd(hn::MulAdd(set(a.squares[4]), u, set(a.squares[3])), u, set(a.squares[2]));
    return hn::MulAdd(hn::MulAdd(hn::NegMulAdd(high, u, f2), u, f1), u, f0);
  };
  const auto falls = [&](V u) {
    const V high = hn::MulAdd(hn::MulAdd(set(5 * a.squares[4]), u, set(4 * a.squares[3])), u, set(3 * a.squares[2]));
    return hn::NegMulSub(hn::NegMulAdd(high, u, hn::Add(f2, f2)), u, f1);
  };
  const V low = set(a.low), high = set(a.high);
  V u = hn::Min(hn::Max(hn::Div(hn::Neg(f0), f1), low), high);
  for (int i = 1; i < a.newton_steps; ++i) u = hn::Min(hn::Max(hn::Add(u, hn::Div(f(u), falls(u))), low), high);
  beyond = hn::Gt(f(set(a.joint)), zero);

  const auto rise = [&](const float(&numbers)[3][3], V u_, int i) { return polynomial<3>(&numbers[0][i], 3, u_, zero); };
  const V3 to{hn::Sub(d.x, rise(a.axis, u, 0)), hn::Sub(d.y, rise(a.axis, u, 1)), hn::Sub(d.z, rise(a.axis, u, 2))}; // d - dc
  const V3 from_axis{hn::Sub(w.x, rise(a.axis, u, 0)), hn::Sub(w.y, rise(a.axis, u, 1)), hn::Sub(w.z, rise(a.axis, u, 2))};
  const V3 tangent{derivative<3>(&a.axis[0][0], 3, u), derivative<3>(&a.axis[0][1], 3, u), derivative<3>(&a.axis[0][2], 3, u)};
  const auto is_free = hn::And(hn::Gt(u, low), hn::Lt(u, high));
  const V rate = hn::IfThenElseZero(is_free, hn::Div(dot(tangent, v), falls(u)));
  const V3 across{hn::NegMulAdd(tangent.x, rate, v.x), hn::NegMulAdd(tangent.y, rate, v.y), hn::NegMulAdd(tangent.z, rate, v.z)};
  const auto moved = [&](int i, V di, V vi) {
    const auto turn = [&](int j) { return polynomial<4>(&a.turn[1][3 * i + j], 9, u, zero); };
    const auto turn_rate = [&](int j) { return derivative<4>(&a.turn[1][3 * i + j], 9, u); };
    const V3 start = vector(&a.turn[0][3 * i]), change{turn(0), turn(1), turn(2)}, changes{turn_rate(0), turn_rate(1), turn_rate(2)};
    const V3 all{hn::Add(start.x, change.x), hn::Add(start.y, change.y), hn::Add(start.z, change.z)};
    const V place = hn::Add(hn::Add(hn::Add(di, rise(a.shift, u, i)), set(a.constant[i])), hn::Add(dot(start, to), dot(change, from_axis)));
    const V along = hn::Add(derivative<3>(&a.shift[0][i], 3, u), dot(changes, from_axis));
    return std::pair{place, hn::Add(vi, hn::MulAdd(along, rate, dot(all, across)))};
  };
  const auto x = moved(0, d.x, v.x), y = moved(1, d.y, v.y), z = moved(2, d.z, v.z);
  return {{x.first, y.first, z.first}, {x.second, y.second, z.second}};
}

/// The pieces one after the other, as many as there are.
inline Curve along_axes(const LaneWarp& w, const LaneAxis* axes, const V3& d, const V3& v) {
  if (w.piece_count == 0) return {d, v};
  M beyond, before;
  Curve c = along_axis(axes[w.first_piece], d, v, beyond);
  for (uint32_t i = 1; i < w.piece_count; ++i) {
    const Curve next = along_axis(axes[w.first_piece + i], d, v, before);
    const auto choose = [&](const V3& a, const V3& b) {
      return V3{hn::IfThenElse(beyond, b.x, a.x), hn::IfThenElse(beyond, b.y, a.y), hn::IfThenElse(beyond, b.z, a.z)};
    };
    c = {choose(c.place, next.place), choose(c.velocity, next.velocity)};
    beyond = hn::And(beyond, before);
  }
  return c;
}

/// From the parent space of a warp to its own.
inline Curve warped(const LaneWarp& w, const LaneAxis* axes, const Curve& parent) {
  const V3 d = times(w.from, parent.place), v = times(w.from, parent.velocity);
  if (w.form == LaneWarp::Form::axial) {
    const Curve c = along_axes(w, axes, d, v);
    return {{hn::Add(c.place.x, set(w.shift[0])), hn::Add(c.place.y, set(w.shift[1])), hn::Add(c.place.z, set(w.shift[2]))}, c.velocity};
  }
  const Curve c = w.form == LaneWarp::Form::twist ? twisted(w, d, v) : w.form == LaneWarp::Form::taper ? tapered(w, d, v) : bent(w, d, v);
  const V3 p = times(w.back, c.place);
  return {{hn::Add(p.x, set(w.shift[0])), hn::Add(p.y, set(w.shift[1])), hn::Add(p.z, set(w.shift[2]))}, times(w.back, c.velocity)};
}

/// For statistics, of so many lanes that count.
inline void count_inversions(const TreeView& tree, const LaneWarp& warp, size_t lanes) {
  AxisWork& work = axis_work();
  work.inversions += lanes, work.in_lanes += lanes, ++work.vectors;
  for (uint32_t i = 0; i < warp.piece_count; ++i)
    work.newton_steps += lanes * static_cast<uint64_t>(tree.axes[warp.first_piece + i].newton_steps);
}

/// What the line is in all spaces of a tree, for so many lanes that count; by_points(i) is asked for those whose warps have no form in
/// lanes.
template <class ByPoints>
void find_curves(const TreeView& tree, const Curve& line, size_t lanes, const ByPoints& by_points, Curve* curves) {
  for (size_t i = 0; i < tree.spaces.size(); ++i) {
    const TreeSpace& space = tree.spaces[i];
    if (space.warp.piece_count > 0) count_inversions(tree, space.warp, lanes);
    const Curve& parent = space.base == 0 ? line : curves[space.base - 1];
    curves[i] = space.warp.form == LaneWarp::Form::none ? by_points(i) : warped(space.warp, tree.axes, parent);
  }
}

/// Puts a place and a velocity into a lane.
struct CurveRows {
  alignas(64) float numbers[6][k_width] = {};

  template <class Place>
  void set_lane(size_t lane, const Place& p) {
    for (int k = 0; k < 3; ++k) numbers[k][lane] = p.at[k], numbers[3 + k][lane] = p.velocity[k];
  }
  Curve curve() const {
    const auto row = [&](size_t k) { return hn::Load(k_lanes, numbers[k]); };
    return {{row(0), row(1), row(2)}, {row(3), row(4), row(5)}};
  }
};

} // namespace HWY_NAMESPACE
} // namespace kelpie
HWY_AFTER_NAMESPACE();

#endif
