// What the two solvers of blobs share. Included once a target.
#if defined(KELPIE_BLOB_LANES_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef KELPIE_BLOB_LANES_INL
#undef KELPIE_BLOB_LANES_INL
#else
#define KELPIE_BLOB_LANES_INL
#endif

#include "field/potential/falloff_terms.h"
#include "renderer/lanes/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace kelpie {
namespace HWY_NAMESPACE {

/// most_bend() of terms of these weights.
inline V most_bend(FalloffCurvature c, V weight) {
  return hn::Max(hn::Mul(weight, set(static_cast<float>(c.c_plus))), hn::Mul(weight, set(static_cast<float>(-c.c_minus))));
}
/// Of potentials q^2 (w + v q).
inline V most_bend(V w, V v) { return hn::Add(most_bend(k_square_curvature, w), most_bend(k_cube_curvature, v)); }

/// A bound of curvature is made wider by this, for rounding.
constexpr float k_wider = 1.0001f;

} // namespace HWY_NAMESPACE
} // namespace kelpie
HWY_AFTER_NAMESPACE();

#endif
