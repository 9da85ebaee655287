// What the two solvers of blobs share. Included once a target.
#if defined(KELPIE_BLOB_LANES_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef KELPIE_BLOB_LANES_INL
#undef KELPIE_BLOB_LANES_INL
#else
#define KELPIE_BLOB_LANES_INL
#endif

#include "field/potential/falloff_terms.h"
#include "renderer/cells/blob_list.h"
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

/// The symmetric matrix of an ellipsoid.
struct ShapeLanes {
  V xx, yy, zz, xy, xz, yz;

  /// From number(BlobShapeRow).
  template <class Number>
  static ShapeLanes of(Number&& number) {
    return {number(shape_xx), number(shape_yy), number(shape_zz), number(shape_xy), number(shape_xz), number(shape_yz)};
  }
  V3 operator()(const V3& d) const { return {dot({xx, xy, xz}, d), dot({xy, yy, yz}, d), dot({xz, yz, zz}, d)}; }
};

/// A blob along a line: q(s) = peak - stretch (s - along)^2, where s counts from the point that the centre is seen from.
struct BlobOnLine {
  V along, stretch, peak;

  /// Of a ball: s - k d^2.
  static BlobOnLine of_ball(V s, V k, const V3& to_centre, const V3& direction) {
    const V along = dot(to_centre, direction);
    const V3 across{hn::NegMulAdd(along, direction.x, to_centre.x), hn::NegMulAdd(along, direction.y, to_centre.y),
                    hn::NegMulAdd(along, direction.z, to_centre.z)};
    return {along, k, hn::NegMulAdd(k, dot(across, across), s)};
  }
  /// The same where the ellipsoid is a ball.
  static BlobOnLine of_ellipsoid(V s, const ShapeLanes& shape, const V3& to_centre, const V3& direction) {
    const V3 u = shape(to_centre), v = shape(direction);
    const V stretch = dot(v, v), along = hn::Div(dot(u, v), stretch);
    const V3 across{hn::NegMulAdd(along, v.x, u.x), hn::NegMulAdd(along, v.y, u.y), hn::NegMulAdd(along, v.z, u.z)};
    return {along, stretch, hn::Sub(s, dot(across, across))};
  }
};

/// A bound of curvature is made wider by this, for rounding.
constexpr float k_wider = 1.0001f;

} // namespace HWY_NAMESPACE
} // namespace kelpie
HWY_AFTER_NAMESPACE();

#endif
