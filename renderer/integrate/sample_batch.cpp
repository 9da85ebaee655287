// Lanes are samples. The formulas are those of sampler.h.

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "renderer/integrate/sample_batch.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <algorithm>

#include "renderer/integrate/sample_batch.h"

HWY_BEFORE_NAMESPACE();
namespace kelpie {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Lanes = hn::CappedTag<uint32_t, 16>;
using V = hn::Vec<Lanes>;
constexpr Lanes k_lanes{};
constexpr size_t k_width = hn::MaxLanes(Lanes{});

inline V set(uint32_t x) { return hn::Set(k_lanes, x); }

/// The bits of a mask change places with those so far below.
template <int k_distance>
V swap_bits(V x, uint32_t lower) {
  const V mask = set(lower);
  return hn::Or(hn::ShiftLeft<k_distance>(hn::And(x, mask)), hn::And(hn::ShiftRight<k_distance>(x), mask));
}

inline V reverse(V x) {
  x = hn::Or(hn::ShiftRight<16>(x), hn::ShiftLeft<16>(x));
  return swap_bits<1>(swap_bits<2>(swap_bits<4>(swap_bits<8>(x, 0x00ff00ffu), 0x0f0f0f0fu), 0x33333333u), 0x55555555u);
}

inline V sobol_second_reversed(V index) {
  index = hn::Xor(index, hn::ShiftRight<16>(index));
  index = hn::Xor(index, hn::ShiftRight<8>(hn::And(index, set(0xff00ff00u))));
  index = hn::Xor(index, hn::ShiftRight<4>(hn::And(index, set(0xf0f0f0f0u))));
  index = hn::Xor(index, hn::ShiftRight<2>(hn::And(index, set(0xccccccccu))));
  return hn::Xor(index, hn::ShiftRight<1>(hn::And(index, set(0xaaaaaaaau))));
}

inline V scramble_reversed(V x, uint32_t seed) {
  x = hn::Add(x, set(seed));
  for (const uint32_t factor : Sampler::k_scramble) x = hn::Xor(x, hn::Mul(x, set(factor)));
  return x;
}

inline void store_units(V x, size_t count, float* out) {
  const hn::RebindToSigned<Lanes> integers;
  const hn::RebindToFloat<Lanes> floats;
  const auto unit = hn::Mul(hn::ConvertTo(floats, hn::BitCast(integers, hn::ShiftRight<8>(x))), hn::Set(floats, 0x1p-24f));
  alignas(64) float values[k_width];
  hn::Store(unit, floats, values);
  std::copy(values, values + std::min(count, k_width), out);
}

/// y may be null.
void Points(PixelSeed pixel, uint32_t pair, uint32_t first, size_t count, float* x, float* y) {
  const uint32_t seed = hash(pixel.seed, pair), seed_x = hash(seed, 1), seed_y = hash(seed, 2);
  for (size_t i = 0; i < count; i += k_width) {
    const V sample = hn::Iota(k_lanes, first + static_cast<uint32_t>(i));
    const V index = reverse(scramble_reversed(reverse(sample), seed));
    store_units(reverse(scramble_reversed(index, seed_x)), count - i, x + i);
    if (y) store_units(reverse(scramble_reversed(sobol_second_reversed(index), seed_y)), count - i, y + i);
  }
}

} // namespace HWY_NAMESPACE
} // namespace kelpie
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace kelpie {

HWY_EXPORT(Points);

namespace {

/// So few are faster one by one.
constexpr size_t k_few = 4;

} // namespace

void next_pairs(PixelSeed pixel, uint32_t pair, uint32_t first, size_t count, float* x, float* y) {
  if (count >= k_few) return HWY_DYNAMIC_DISPATCH(Points)(pixel, pair, first, count, x, y);
  for (size_t i = 0; i < count; ++i) {
    const Vec2 point = Sampler(pixel, first + static_cast<uint32_t>(i), pair).next_pair();
    x[i] = point.x, y[i] = point.y;
  }
}

void next_numbers(PixelSeed pixel, uint32_t pair, uint32_t first, size_t count, float* x) {
  if (count >= k_few) return HWY_DYNAMIC_DISPATCH(Points)(pixel, pair, first, count, x, nullptr);
  for (size_t i = 0; i < count; ++i) x[i] = Sampler(pixel, first + static_cast<uint32_t>(i), pair).next();
}

} // namespace kelpie
#endif
