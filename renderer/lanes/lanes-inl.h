// Vectors of up to 16 floats, and points in their lanes. Included once a target.
#if defined(KELPIE_LANES_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef KELPIE_LANES_INL
#undef KELPIE_LANES_INL
#else
#define KELPIE_LANES_INL
#endif

#include <hwy/highway.h>

#include "base/vec.h"
#include "renderer/lanes/packet.h"

HWY_BEFORE_NAMESPACE();
namespace kelpie {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Lanes = hn::CappedTag<float, k_packet>;
using IntLanes = hn::RebindToSigned<Lanes>;
using V = hn::Vec<Lanes>;
using M = hn::Mask<Lanes>;
constexpr Lanes k_lanes{};
constexpr size_t k_width = hn::MaxLanes(Lanes{});

/// A point or direction of each lane.
struct V3 {
  V x, y, z;
};

inline V dot(const V3& a, const V3& b) { return hn::MulAdd(a.x, b.x, hn::MulAdd(a.y, b.y, hn::Mul(a.z, b.z))); }
inline V set(float v) { return hn::Set(k_lanes, v); }
inline V square_of_positive(V v) {
  const V p = hn::Max(v, hn::Zero(k_lanes));
  return hn::Mul(p, p);
}
inline bool none(M m) { return hn::AllFalse(k_lanes, m); }

inline M no_lanes() { return hn::Lt(hn::Zero(k_lanes), hn::Zero(k_lanes)); }

inline uint32_t bits_of(M m) {
  uint8_t bytes[8] = {};
  hn::StoreMaskBits(k_lanes, m, bytes);
  return bytes[0] | uint32_t(bytes[1]) << 8;
}

} // namespace HWY_NAMESPACE
} // namespace kelpie
HWY_AFTER_NAMESPACE();

#endif
