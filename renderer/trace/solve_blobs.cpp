// The solver for sums of blobs. Along a ray, centred on the segment (s in [-h, h]), each blob's
// q = s_i - k_i |p - c_i|^2 is a quadratic in s, kept as a - (c s - b)^2 from the place nearest to the centre: nothing
// cancels, however far the blob is. The field is sampled at 16 places in SIMD lanes; a root
// pair hidden between two samples is ruled out by a bound of the field's curvature from below,
//   f'' >= -C   =>   f <= lerp + (C/2) (s - s_j) (s_{j+1} - s),
// and what is not ruled out is sampled 15 times finer. Nothing is missed, nothing is guessed.

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "renderer/trace/solve_blobs.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "renderer/trace/blob_lanes-inl.h"
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
static_assert(k_samples == k_packet); // as many as lanes at the most

} // namespace kelpie
#endif

HWY_BEFORE_NAMESPACE();
namespace kelpie {
namespace HWY_NAMESPACE {

constexpr size_t k_vectors = k_samples / k_width;

/// Where the 16 samples lie in [-1, 1].
alignas(64) constexpr float k_places[k_samples] = {-1,       -13.f / 15, -11.f / 15, -9.f / 15, -7.f / 15, -5.f / 15, -3.f / 15, -1.f / 15,
                                                   1.f / 15, 3.f / 15,   5.f / 15,   7.f / 15,  9.f / 15,  11.f / 15, 13.f / 15, 1};

/// Some blobs of a list, at a time within the slab.
template <BlobForm F>
struct BlobGroup {
  BlobGroup(const BlobList& blobs, size_t i, V time) {
    const auto standing = [&](BlobRow row) { return hn::LoadU(k_lanes, blobs.row(row) + i); };
    const auto number = [&](BlobRow row) {
      if constexpr (F.moves) return hn::MulAdd(hn::LoadU(k_lanes, blobs.row(F.change_of(row)) + i), time, standing(row));
      return standing(row);
    };
    x = number(blob_x), y = number(blob_y), z = number(blob_z);
    s = standing(blob_s);
    if constexpr (!F.is_pure) w = number(blob_a), v = number(blob_b);
    if constexpr (F.is_round)
      k = F.is_pure ? standing(blob_k) : number(blob_k);
    else
      shape = ShapeLanes::of([&](BlobShapeRow row) {
        const V at_start = hn::LoadU(k_lanes, blobs.row(F.row_of(row)) + i);
        if constexpr (F.moves && !F.is_pure) return hn::MulAdd(hn::LoadU(k_lanes, blobs.row(F.change_of(row)) + i), time, at_start);
        return at_start;
      });
  }

  BlobOnLine along(const V3& to_blob, const V3& direction) const {
    if constexpr (F.is_round) return BlobOnLine::of_ball(s, k, to_blob, direction);
    return BlobOnLine::of_ellipsoid(s, shape, to_blob, direction);
  }

  V x, y, z, s;
  V k;              ///< only of round ones
  ShapeLanes shape; ///< only of others
  V w, v;           ///< only of mixed ones
};

template <BlobForm F>
class BlobSolver {
public:
  BlobSolver(float threshold, bool from_inside, SolverWork& work, ActiveBlobs& active)
      : threshold_(threshold), sign_(from_inside ? -1.f : 1.f), negligible_(1e-5f * threshold), work_(work), active_(active) {}

  bool run(BlobList blobs, const RaySegment& ray, float slab_time, float& t) {
    const float middle = 0.5f * (ray.t0 + ray.t1);
    // A direction is a unit vector to 1e-7 only, which a tiny blob at the end of a long segment would feel.
    const float speed = glm::length(ray.direction), half = 0.5f * (ray.t1 - ray.t0) * speed;
    const float most = set_up(blobs, ray.origin + middle * ray.direction, ray.direction / speed, half, slab_time);
    if (sign_ > 0 && most < threshold_ * (1 - 1e-6f)) return false;
    float root;
    if (!first(-half, half, 0, root)) return false;
    t = middle + root / speed;
    return true;
  }

private:
  /// Fills the list of active blobs; returns an upper bound of the field on the segment.
  float set_up(BlobList blobs, const Vec3& m, const Vec3& d, float half, float slab_time) {
    active_.reserve(blobs.count);
    const V3 middle{set(m.x), set(m.y), set(m.z)}, direction{set(d.x), set(d.y), set(d.z)};
    const V h = set(half), zero = hn::Zero(k_lanes), time = set(slab_time);
    V curvature = zero, most = zero;
    size_t count = 0;
    for (size_t i = 0; i < blobs.count; i += k_width) {
      const BlobGroup<F> group(blobs, i, time);
      const V3 to_blob{hn::Sub(group.x, middle.x), hn::Sub(group.y, middle.y), hn::Sub(group.z, middle.z)};
      const auto [along, k, a] = group.along(to_blob, direction);
      const V c = hn::Sqrt(k), b = hn::Mul(c, along);
      // q is largest at the place nearest to the centre.
      const V off = hn::Sub(hn::Min(hn::Max(along, hn::Neg(h)), h), along);
      const V q = hn::NegMulAdd(k, hn::Mul(off, off), a);
      const auto reaches = hn::Gt(q, zero);
      if (hn::AllFalse(k_lanes, reaches)) continue;
      hn::CompressStore(a, reaches, k_lanes, active_.a.data() + count);
      hn::CompressStore(b, reaches, k_lanes, active_.b.data() + count);
      if constexpr (F.is_pure) {
        // q is scaled by the root s of the weight w: w times the curvature of q^2 is s (s k) times it.
        curvature = hn::Add(curvature, hn::IfThenElseZero(reaches, hn::Mul(group.s, k)));
        most = hn::Add(most, hn::IfThenElseZero(reaches, hn::Mul(q, q)));
      } else {
        const V w = group.w, v = group.v;
        hn::CompressStore(w, reaches, k_lanes, active_.w.data() + count);
        hn::CompressStore(v, reaches, k_lanes, active_.v.data() + count);
        const V bend = most_bend(hn::Mul(w, set(sign_)), hn::Mul(v, set(sign_)));
        curvature = hn::Add(curvature, hn::IfThenElseZero(reaches, hn::Mul(bend, k)));
        const V peak = hn::Mul(hn::Mul(q, q), hn::MulAdd(v, q, w));
        most = hn::Add(most, hn::IfThenElseZero(reaches, hn::Max(peak, zero)));
      }
      count += hn::CompressStore(c, reaches, k_lanes, active_.c.data() + count);
    }
    active_.count = count;
    for (size_t j = 0; j < k_width; ++j) { // so that whole vectors may be read: q = -1
      active_.a[count + j] = -1, active_.b[count + j] = active_.c[count + j] = 0;
      if constexpr (!F.is_pure) active_.w[count + j] = active_.v[count + j] = 0;
    }
    const float sum = hn::GetLane(hn::SumOfLanes(k_lanes, curvature));
    curvature_ = k_wider * (F.is_pure ? most_bend(k_square_curvature, sign_) * sum : sum);
    return hn::GetLane(hn::SumOfLanes(k_lanes, most));
  }

  /// g = ±(f - T) at 16 places; negative before the surface.
  void sample(float middle, float half, float* g) const {
    work_.evaluations += k_samples;
    V s[k_vectors], f[k_vectors];
    for (size_t j = 0; j < k_vectors; ++j) {
      s[j] = hn::MulAdd(hn::Load(k_lanes, k_places + j * k_width), set(half), set(middle));
      f[j] = set(-threshold_);
    }
    const V zero = hn::Zero(k_lanes);
    for (size_t i = 0; i < active_.count; ++i) {
      const V a = set(active_.a[i]), b = set(active_.b[i]), c = set(active_.c[i]);
      for (size_t j = 0; j < k_vectors; ++j) {
        const V u = hn::MulSub(c, s[j], b), q = hn::Max(hn::NegMulAdd(u, u, a), zero);
        if constexpr (F.is_pure)
          f[j] = hn::MulAdd(q, q, f[j]);
        else
          f[j] = hn::MulAdd(hn::Mul(q, q), hn::MulAdd(set(active_.v[i]), q, set(active_.w[i])), f[j]);
      }
    }
    for (size_t j = 0; j < k_vectors; ++j) hn::Store(hn::Mul(f[j], set(sign_)), k_lanes, g + j * k_width);
  }

  /// g at one place, with blobs in lanes.
  float at(float place) const {
    ++work_.evaluations;
    const V s = set(place), zero = hn::Zero(k_lanes);
    V f = zero;
    for (size_t i = 0; i < active_.count; i += k_width) {
      const V u = hn::MulSub(hn::LoadU(k_lanes, &active_.c[i]), s, hn::LoadU(k_lanes, &active_.b[i]));
      const V q = hn::Max(hn::NegMulAdd(u, u, hn::LoadU(k_lanes, &active_.a[i])), zero);
      if constexpr (F.is_pure)
        f = hn::MulAdd(q, q, f);
      else
        f = hn::MulAdd(hn::Mul(q, q), hn::MulAdd(hn::LoadU(k_lanes, &active_.v[i]), q, hn::LoadU(k_lanes, &active_.w[i])), f);
    }
    return sign_ * (hn::GetLane(hn::SumOfLanes(k_lanes, f)) - threshold_);
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

bool SolveBlobs(const ShapeCells& shape, const Cell& cell, const RaySegment& ray, SolverWork& work, float& t) {
  thread_local ActiveBlobs active;
  const float u = shape.slab_time(ray.time);
  const auto threshold = static_cast<float>(threshold_at(shape.program, u));
  return for_form(cell.blobs.form,
                  [&]<BlobForm F>() { return BlobSolver<F>(threshold, ray.from_inside, work, active).run(cell.blobs, ray, u, t); });
}

/// d/dp of q^2 (w + v q) with q = s - k |p - c|^2: -2 k q (2 w + 3 v q) (p - c), and m m instead of k for ellipsoids.
template <BlobForm F>
Vec3 gradient_of(BlobList blobs, const Vec3& p, float slab_time) {
  const V3 place{set(p.x), set(p.y), set(p.z)};
  const V zero = hn::Zero(k_lanes), time = set(slab_time);
  V3 sum{zero, zero, zero};
  for (size_t i = 0; i < blobs.count; i += k_width) {
    const BlobGroup<F> group(blobs, i, time);
    const V3 d{hn::Sub(place.x, group.x), hn::Sub(place.y, group.y), hn::Sub(place.z, group.z)};
    V q, k = set(1);
    V3 way = d;
    if constexpr (F.is_round) {
      k = group.k, q = hn::NegMulAdd(k, dot(d, d), group.s);
    } else {
      const V3 u = group.shape(d);
      way = group.shape(u), q = hn::Sub(group.s, dot(u, u));
    }
    q = hn::Max(q, zero);
    V slope = set(2);
    if constexpr (!F.is_pure) slope = hn::MulAdd(hn::Mul(set(3), group.v), q, hn::Add(group.w, group.w));
    const V factor = hn::Mul(hn::Mul(k, q), slope);
    sum = {hn::MulAdd(factor, way.x, sum.x), hn::MulAdd(factor, way.y, sum.y), hn::MulAdd(factor, way.z, sum.z)};
  }
  const auto total = [](V g) { return -2 * hn::GetLane(hn::SumOfLanes(k_lanes, g)); };
  return {total(sum.x), total(sum.y), total(sum.z)};
}

Vec3 BlobsGradient(const ShapeCells& shape, const Cell& cell, const Vec3& p, float time) {
  return for_form(cell.blobs.form, [&]<BlobForm F>() { return gradient_of<F>(cell.blobs, p, shape.slab_time(time)); });
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
