// The solver for sums of point blobs. Along a ray, centred on the segment (s in [-h, h]), each blob's
// q = s_i - k_i |p - c_i|^2 is a quadratic in s, kept as a - (c s - b)^2 from the place nearest to the centre: nothing
// cancels, however far the blob is. The field is sampled at 16 places in SIMD lanes; a root
// pair hidden between two samples is ruled out by a bound of the field's curvature from below,
//   f'' >= -C   =>   f <= lerp + (C/2) (s - s_j) (s_{j+1} - s),
// and what is not ruled out is sampled 15 times finer. Nothing is missed, nothing is guessed.

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "renderer/trace/solve_blobs.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "renderer/trace/bracketed_root.h"
#include "renderer/trace/solve.h"

#ifndef KELPIE_SOLVE_BLOBS_ONCE
#define KELPIE_SOLVE_BLOBS_ONCE
namespace kelpie {

/// The quadratics q(s) = a - (c s - b)^2 of the blobs that the segment can meet; potential q^2 (w + v q).
struct ActiveBlobs {
  std::vector<float> a, b, c, w, v;
  size_t count = 0;

  void reserve(size_t n) {
    if (a.size() < n + 2 * k_leaf_group)
      for (auto* list : {&a, &b, &c, &w, &v}) list->resize(n + 2 * k_leaf_group);
  }
};

inline constexpr int k_samples = 16;

/// What a list of blobs holds (Cell::Content).
template <Cell::Content C>
struct BlobForm {
  /// Quartic falloffs and positive weights only, weights folded into q. Then f = sum q^2.
  static constexpr bool k_pure = C == Cell::Content::pure_blobs || C == Cell::Content::moving_pure_blobs;
  static constexpr bool k_moving = C == Cell::Content::moving_pure_blobs || C == Cell::Content::moving_mixed_blobs;
};

} // namespace kelpie
#endif

HWY_BEFORE_NAMESPACE();
namespace kelpie {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Lanes = hn::CappedTag<float, k_samples>;
using V = hn::Vec<Lanes>;
constexpr Lanes k_lanes{};
constexpr size_t k_width = hn::MaxLanes(Lanes{});
constexpr size_t k_vectors = k_samples / k_width;

/// Where the 16 samples lie in [-1, 1].
alignas(64) constexpr float k_places[k_samples] = {-1,       -13.f / 15, -11.f / 15, -9.f / 15, -7.f / 15, -5.f / 15, -3.f / 15, -1.f / 15,
                                                   1.f / 15, 3.f / 15,   5.f / 15,   7.f / 15,  9.f / 15,  11.f / 15, 13.f / 15, 1};

/// Some blobs of a list, at a time.
template <Cell::Content C>
struct BlobGroup {
  BlobGroup(const float* blobs, size_t n, size_t i, V u) {
    const Lanes l = k_lanes;
    const auto number = [&](size_t array, size_t change) {
      const V start = hn::LoadU(l, blobs + array * n + i);
      if constexpr (BlobForm<C>::k_moving) return hn::MulAdd(hn::LoadU(l, blobs + change * n + i), u, start);
      return start;
    };
    constexpr size_t first = BlobForm<C>::k_pure ? 5 : 7;
    x = number(0, first), y = number(1, first + 1), z = number(2, first + 2);
    s = hn::LoadU(l, blobs + 3 * n + i);
    if constexpr (BlobForm<C>::k_pure)
      k = hn::LoadU(l, blobs + 4 * n + i);
    else
      k = number(4, 10), w = number(5, 11), v = number(6, 12);
  }

  V x, y, z, s, k, w, v; ///< w and v only of mixed ones
};

template <Cell::Content C>
class BlobSolver {
  static constexpr bool k_pure = BlobForm<C>::k_pure;

public:
  BlobSolver(float threshold, bool from_inside, SolverWork& work, ActiveBlobs& active)
      : threshold_(threshold), sign_(from_inside ? -1.f : 1.f), negligible_(1e-5f * threshold), work_(work), active_(active) {}

  bool run(const float* blobs, size_t n, const RaySegment& ray, float slab_time, float& t) {
    const float middle = 0.5f * (ray.t0 + ray.t1);
    // A direction is a unit vector to 1e-7 only, which a tiny blob at the end of a long segment would feel.
    const float speed = glm::length(ray.direction), half = 0.5f * (ray.t1 - ray.t0) * speed;
    const float most = set_up(blobs, n, ray.origin + middle * ray.direction, ray.direction / speed, half, slab_time);
    if (sign_ > 0 && most < threshold_ * (1 - 1e-6f)) return false;
    float root;
    if (!first(-half, half, 0, root)) return false;
    t = middle + root / speed;
    return true;
  }

private:
  /// Fills the list of active blobs; returns an upper bound of the field on the segment.
  float set_up(const float* blobs, size_t n, const Vec3& m, const Vec3& d, float half, float slab_time) {
    const Lanes l = k_lanes;
    active_.reserve(n);
    const V mx = hn::Set(l, m.x), my = hn::Set(l, m.y), mz = hn::Set(l, m.z);
    const V dx = hn::Set(l, d.x), dy = hn::Set(l, d.y), dz = hn::Set(l, d.z);
    const V h = hn::Set(l, half), zero = hn::Zero(l), u = hn::Set(l, slab_time);
    V curvature = zero, most = zero;
    size_t count = 0;
    for (size_t i = 0; i < n; i += k_width) {
      const BlobGroup<C> group(blobs, n, i, u);
      const V x = hn::Sub(group.x, mx), y = hn::Sub(group.y, my), z = hn::Sub(group.z, mz), s = group.s, k = group.k;
      const V along = hn::MulAdd(x, dx, hn::MulAdd(y, dy, hn::Mul(z, dz)));
      const V ax = hn::NegMulAdd(along, dx, x), ay = hn::NegMulAdd(along, dy, y), az = hn::NegMulAdd(along, dz, z);
      const V a = hn::NegMulAdd(k, hn::MulAdd(ax, ax, hn::MulAdd(ay, ay, hn::Mul(az, az))), s);
      const V c = hn::Sqrt(k), b = hn::Mul(c, along);
      // q is largest at the place nearest to the centre.
      const V off = hn::Sub(hn::Min(hn::Max(along, hn::Neg(h)), h), along);
      const V q = hn::NegMulAdd(k, hn::Mul(off, off), a);
      const auto reaches = hn::Gt(q, zero);
      if (hn::AllFalse(l, reaches)) continue;
      hn::CompressStore(a, reaches, l, active_.a.data() + count);
      hn::CompressStore(b, reaches, l, active_.b.data() + count);
      if constexpr (k_pure) {
        // q^2 with q scaled by the root s of the weight: C = 4 w k = 4 s (s k); upward 8.
        curvature = hn::Add(curvature, hn::IfThenElseZero(reaches, hn::Mul(s, k)));
        most = hn::Add(most, hn::IfThenElseZero(reaches, hn::Mul(q, q)));
      } else {
        const V w = group.w, v = group.v;
        hn::CompressStore(w, reaches, l, active_.w.data() + count);
        hn::CompressStore(v, reaches, l, active_.v.data() + count);
        // (4, 8) for q^2, (6, 4.8) for q^3: the first where the potential curves against us.
        const V sw = hn::Mul(w, hn::Set(l, sign_)), sv = hn::Mul(v, hn::Set(l, sign_));
        const V bend = hn::Add(hn::Max(hn::Mul(sw, hn::Set(l, 4.f)), hn::Mul(sw, hn::Set(l, -8.f))),
                               hn::Max(hn::Mul(sv, hn::Set(l, 6.f)), hn::Mul(sv, hn::Set(l, -4.8f))));
        curvature = hn::Add(curvature, hn::IfThenElseZero(reaches, hn::Mul(bend, k)));
        const V peak = hn::Mul(hn::Mul(q, q), hn::MulAdd(v, q, w));
        most = hn::Add(most, hn::IfThenElseZero(reaches, hn::Max(peak, zero)));
      }
      count += hn::CompressStore(c, reaches, l, active_.c.data() + count);
    }
    active_.count = count;
    for (size_t j = 0; j < k_width; ++j) { // so that whole vectors may be read: q = -1
      active_.a[count + j] = -1, active_.b[count + j] = active_.c[count + j] = 0;
      if constexpr (!k_pure) active_.w[count + j] = active_.v[count + j] = 0;
    }
    const float sum = hn::GetLane(hn::SumOfLanes(l, curvature));
    curvature_ = 1.0001f * (k_pure ? (sign_ > 0 ? 4 : 8) * sum : sum);
    return hn::GetLane(hn::SumOfLanes(l, most));
  }

  /// g = ±(f - T) at 16 places; negative before the surface.
  void sample(float middle, float half, float* g) const {
    work_.evaluations += k_samples;
    const Lanes l = k_lanes;
    V s[k_vectors], f[k_vectors];
    for (size_t j = 0; j < k_vectors; ++j) {
      s[j] = hn::MulAdd(hn::Load(l, k_places + j * k_width), hn::Set(l, half), hn::Set(l, middle));
      f[j] = hn::Set(l, -threshold_);
    }
    const V zero = hn::Zero(l);
    for (size_t i = 0; i < active_.count; ++i) {
      const V a = hn::Set(l, active_.a[i]), b = hn::Set(l, active_.b[i]), c = hn::Set(l, active_.c[i]);
      for (size_t j = 0; j < k_vectors; ++j) {
        const V u = hn::MulSub(c, s[j], b), q = hn::Max(hn::NegMulAdd(u, u, a), zero);
        if constexpr (k_pure)
          f[j] = hn::MulAdd(q, q, f[j]);
        else
          f[j] = hn::MulAdd(hn::Mul(q, q), hn::MulAdd(hn::Set(l, active_.v[i]), q, hn::Set(l, active_.w[i])), f[j]);
      }
    }
    for (size_t j = 0; j < k_vectors; ++j) hn::Store(hn::Mul(f[j], hn::Set(l, sign_)), l, g + j * k_width);
  }

  /// g at one place, with blobs in lanes.
  float at(float place) const {
    ++work_.evaluations;
    const Lanes l = k_lanes;
    const V s = hn::Set(l, place), zero = hn::Zero(l);
    V f = zero;
    for (size_t i = 0; i < active_.count; i += k_width) {
      const V u = hn::MulSub(hn::LoadU(l, &active_.c[i]), s, hn::LoadU(l, &active_.b[i]));
      const V q = hn::Max(hn::NegMulAdd(u, u, hn::LoadU(l, &active_.a[i])), zero);
      if constexpr (k_pure)
        f = hn::MulAdd(q, q, f);
      else
        f = hn::MulAdd(hn::Mul(q, q), hn::MulAdd(hn::LoadU(l, &active_.v[i]), q, hn::LoadU(l, &active_.w[i])), f);
    }
    return sign_ * (hn::GetLane(hn::SumOfLanes(l, f)) - threshold_);
  }

  /// Whether g, below 0 at both ends of an interval, may exceed the negligible between them. With
  /// D = C h^2 / 2 the bound lerp + D u (1 - u) peaks inside the interval where |g1 - g0| < D.
  bool may_hide(float g0, float g1, float bulge) const {
    const float rise = g1 - g0;
    if (bulge < 4 * negligible_ || std::abs(rise) >= bulge) return false;
    return 0.5f * (g0 + g1) + 0.25f * bulge + rise * rise / (4 * bulge) >= negligible_;
  }

  /// The first place in [s0, s1] with g >= 0.
  bool first(float s0, float s1, int depth, float& root) const {
    alignas(64) float g[k_samples];
    const float middle = 0.5f * (s0 + s1), half = 0.5f * (s1 - s0), step = half * (2.f / 15);
    sample(middle, half, g);
    if (g[0] >= 0) {
      root = s0;
      return true;
    }
    const float bulge = 0.5f * curvature_ * step * step;
    const bool splits = depth < 6 && step > 1e-7f * (std::abs(s0) + std::abs(s1));
    const auto place = [&](int j) { return middle + k_places[j] * half; };
    for (int j = 0; j + 1 < k_samples; ++j) {
      if (g[j + 1] >= 0) {
        root = root_between(place(j), g[j], place(j + 1), g[j + 1]);
        // Two more roots may hide before this one, unless the bound is negative up to it.
        const float before = root - place(j), arch = 0.5f * curvature_ * before * before;
        float nearer;
        if (splits && arch > -g[j] && arch > 4 * negligible_ && first(place(j), root, depth + 1, nearer)) root = nearer;
        return true;
      }
      if (splits && may_hide(g[j], g[j + 1], bulge) && first(place(j), place(j + 1), depth + 1, root)) return true;
    }
    return false;
  }

  float root_between(float a, float ga, float b, float gb) const {
    return bracketed_root([&](float s) { return at(s); }, a, ga, b, gb, 1e-6f * threshold_);
  }

  float threshold_, sign_, negligible_;
  float curvature_ = 0; ///< C: sign * f'' >= -C on the segment
  SolverWork& work_;
  ActiveBlobs& active_;
};

/// Calls run.operator()<content>() for the content of a cell of blobs.
template <class Run>
auto for_content(Cell::Content content, Run&& run) {
  using C = Cell::Content;
  switch (content) {
  case C::pure_blobs: return run.template operator()<C::pure_blobs>();
  case C::moving_pure_blobs: return run.template operator()<C::moving_pure_blobs>();
  case C::moving_mixed_blobs: return run.template operator()<C::moving_mixed_blobs>();
  default: return run.template operator()<C::mixed_blobs>();
  }
}

bool SolveBlobs(const ShapeCells& shape, const Cell& cell, const RaySegment& ray, SolverWork& work, float& t) {
  thread_local ActiveBlobs active;
  const float u = shape.slab_time(ray.time);
  const auto threshold = static_cast<float>(threshold_at(shape.program, u));
  return for_content(cell.content, [&]<Cell::Content C>() {
    return BlobSolver<C>(threshold, ray.from_inside, work, active).run(cell.data, cell.count, ray, u, t);
  });
}

/// d/dp of q^2 (w + v q) with q = s - k |p - c|^2: -2 k q (2 w + 3 v q) (p - c).
template <Cell::Content C>
Vec3 gradient_of(const float* blobs, size_t n, const Vec3& p, float slab_time) {
  const Lanes l = k_lanes;
  const V px = hn::Set(l, p.x), py = hn::Set(l, p.y), pz = hn::Set(l, p.z), zero = hn::Zero(l), u = hn::Set(l, slab_time);
  V gx = zero, gy = zero, gz = zero;
  for (size_t i = 0; i < n; i += k_width) {
    const BlobGroup<C> group(blobs, n, i, u);
    const V x = hn::Sub(px, group.x), y = hn::Sub(py, group.y), z = hn::Sub(pz, group.z);
    const V q = hn::Max(hn::NegMulAdd(group.k, hn::MulAdd(x, x, hn::MulAdd(y, y, hn::Mul(z, z))), group.s), zero);
    V slope = hn::Set(l, 2.f);
    if constexpr (!BlobForm<C>::k_pure) slope = hn::MulAdd(hn::Mul(hn::Set(l, 3.f), group.v), q, hn::Add(group.w, group.w));
    const V factor = hn::Mul(hn::Mul(group.k, q), slope);
    gx = hn::MulAdd(factor, x, gx), gy = hn::MulAdd(factor, y, gy), gz = hn::MulAdd(factor, z, gz);
  }
  const auto total = [&](V g) { return -2 * hn::GetLane(hn::SumOfLanes(l, g)); };
  return {total(gx), total(gy), total(gz)};
}

Vec3 BlobsGradient(const ShapeCells& shape, const Cell& cell, const Vec3& p, float time) {
  return for_content(cell.content,
                     [&]<Cell::Content C>() { return gradient_of<C>(cell.data, cell.count, p, shape.slab_time(time)); });
}

} // namespace HWY_NAMESPACE
} // namespace kelpie
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace kelpie {

HWY_EXPORT(SolveBlobs);
HWY_EXPORT(BlobsGradient);

bool solve_blobs(const ShapeCells& shape, const Cell& cell, const RaySegment& ray, SolverWork& work, float& t) {
  return HWY_DYNAMIC_DISPATCH(SolveBlobs)(shape, cell, ray, work, t);
}

Vec3 blobs_gradient(const ShapeCells& shape, const Cell& cell, const Vec3& p, float time) {
  return HWY_DYNAMIC_DISPATCH(BlobsGradient)(shape, cell, p, time);
}

} // namespace kelpie
#endif
