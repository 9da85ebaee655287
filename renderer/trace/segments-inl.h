// What the solvers with rays in SIMD lanes share: a packet's rays clipped to a cell, and the way to the solvers of single rays.
// Included once a target.
#if defined(KELPIE_SEGMENTS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef KELPIE_SEGMENTS_INL
#undef KELPIE_SEGMENTS_INL
#else
#define KELPIE_SEGMENTS_INL
#endif

#include "renderer/lanes/lanes-inl.h"
#include "renderer/trace/solve.h"

HWY_BEFORE_NAMESPACE();
namespace kelpie {
namespace HWY_NAMESPACE {

/// Rays `first`, first + 1, … of a packet in their cell, as clip() has them.
struct Segments {
  V3 origin, direction;
  V t0, t1, entry, time;
  M live;

  Segments(const RayLanes& rays, size_t first, const Box3& box)
      : origin{load(rays.origin_x + first), load(rays.origin_y + first), load(rays.origin_z + first)}, direction{
                                                                                                           load(rays.direction_x + first),
                                                                                                           load(rays.direction_y + first),
                                                                                                           load(rays.direction_z + first)} {
    const V near = load(rays.t_near + first);
    entry = near, t1 = set(std::numeric_limits<float>::infinity()), time = load(rays.time + first);
    slab(box.lower.x, box.upper.x, origin.x, direction.x);
    slab(box.lower.y, box.upper.y, origin.y, direction.y);
    slab(box.lower.z, box.upper.z, origin.z, direction.z);
    const V far = load(rays.t_far + first);
    const auto valid = hn::Ne(hn::LoadU(IntLanes{}, rays.valid + first), hn::Zero(IntLanes{}));
    live = hn::And(hn::RebindMask(k_lanes, valid), hn::And(hn::Le(entry, t1), hn::Le(entry, far)));
    const V pad = hn::MulAdd(set(1e-6f), hn::Abs(t1), set(1e-6f));
    t0 = hn::Max(hn::Sub(entry, pad), near), t1 = hn::Add(t1, pad);
  }

private:
  static V load(const float* p) { return hn::LoadU(k_lanes, p); }

  /// NaN leaves the bounds as they are, as in clip().
  void slab(float lower, float upper, V o, V d) {
    const V inverse = hn::Div(set(1), d);
    const V a = hn::Mul(hn::Sub(set(lower), o), inverse), b = hn::Mul(hn::Sub(set(upper), o), inverse);
    const auto forward = hn::Lt(a, b);
    const V in = hn::IfThenElse(forward, a, b), out = hn::IfThenElse(forward, b, a);
    entry = hn::IfThenElse(hn::Gt(in, entry), in, entry);
    t1 = hn::IfThenElse(hn::Lt(out, t1), out, t1);
  }
};

/// Answers the lanes that are unsure one by one, by the solver for single rays.
template <class Solver>
void settle(const Solver& solver, const ShapeCells& shape, const Cell& cell, const RayLanes& rays, size_t first, const Segments& segments,
            uint32_t unsure, uint32_t& hits, SolverWork& work, float* t) {
  alignas(64) float t0[k_width], t1[k_width], entry[k_width];
  hn::Store(segments.t0, k_lanes, t0), hn::Store(segments.t1, k_lanes, t1), hn::Store(segments.entry, k_lanes, entry);
  for (size_t i = 0; i < k_width; ++i) {
    if (!(unsure >> i & 1)) continue;
    const Ray ray = rays.ray(first + i);
    float root;
    if (!solver(shape, cell, {ray.origin, ray.direction, t0[i], t1[i], entry[i], false, ray.time}, work, root)) continue;
    root = std::max(root, entry[i]);
    t[i] = hits >> i & 1 ? std::min(root, t[i]) : root;
    hits |= 1u << i;
  }
}

} // namespace HWY_NAMESPACE
} // namespace kelpie
HWY_AFTER_NAMESPACE();

#endif
