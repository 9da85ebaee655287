// The time of one vector of inversions of an axis, as the solvers have them.

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "bench/lane_inversion.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "bench/lane_inversion.h"
#include "renderer/lanes/warp_lanes-inl.h"
#include "renderer/render_frame.h"

HWY_BEFORE_NAMESPACE();
namespace kelpie {
namespace HWY_NAMESPACE {

/// Places and velocities of a lane each, in all warps; the seconds of one.
double TimeVectors(std::span<const LaneWarp> warps, const LaneAxis* axes, float size, float& sum) {
  constexpr int k_rounds = 200;
  alignas(64) float spread[k_width];
  for (size_t i = 0; i < k_width; ++i) spread[i] = size * (float(i + 1) / float(k_width) - 0.5f);
  V all = hn::Zero(k_lanes);
  const V at = hn::Load(k_lanes, spread);
  const double start = process_cpu_s();
  for (int round = 0; round < k_rounds; ++round)
    for (const LaneWarp& w : warps) {
      const V s = hn::MulAdd(at, set(float(round) / k_rounds), hn::Mul(all, hn::Zero(k_lanes))); // one after the other, as along a ray
      const Curve c = warped(w, axes, {{s, at, s}, {set(0.6f), set(0.64f), set(0.48f)}});
      all = hn::Add(all, hn::Add(c.place.x, c.velocity.y));
    }
  const double seconds = process_cpu_s() - start;
  sum = hn::GetLane(all); // so that nothing is left out
  return seconds / (double(k_rounds) * double(warps.size()));
}

} // namespace HWY_NAMESPACE
} // namespace kelpie
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace kelpie {

HWY_EXPORT(TimeVectors);

double time_lane_inversion(std::span<const LaneWarp> warps, const LaneAxis* axes, float size) {
  float sum = 0;
  const double seconds = HWY_DYNAMIC_DISPATCH(TimeVectors)(warps, axes, size, sum);
  return std::isnan(sum) ? 0 : seconds;
}

} // namespace kelpie
#endif
