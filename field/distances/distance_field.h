// Signed distances as leaves: what every kind of this folder shares.
//
// A signed distance d is a length, negative inside; a potential f has no unit, and is 0 outside a support. Where f is asked for
// d becomes
//   distance   f = weight T clamp(1 - d / reach, 0, 2),   T the threshold of the shape:
//              with weight 1 the surface is exactly where d = 0, whatever the reach; f is T - d T / reach, cut off where it is 0
//              and where it is 2T, so that supports are compact, Booleans exact, and a blend above it does no harm;
//   else       f = weight falloff(max(0, d)^2 / reach^2),   as of any skeleton: soft, and thicker than the solid.
// Rejected: f = T - d as it is. It has no support, so nothing could be pruned, and it depends on the unit of length.
#pragma once

#include "field/potential/falloff.h"
#include "field/skeletons/frame.h"

namespace kelpie {

/// How a potential falls from a solid's surface to the end of its reach.
enum class DistanceFalloff { distance, quartic, cubic, wyvill };

template <>
struct EnumNames<DistanceFalloff> {
  static constexpr std::array<std::pair<std::string_view, DistanceFalloff>, 4> values{{{"distance", DistanceFalloff::distance},
                                                                                       {"quartic", DistanceFalloff::quartic},
                                                                                       {"cubic", DistanceFalloff::cubic},
                                                                                       {"wyvill", DistanceFalloff::wyvill}}};
};

/// What a kind K of signed distance is by what it has: `Real signed_distance(Point3<Real>)` for double, Interval and Dual,
/// `Box3d solid_box()` around the solid, `double inner_radius()` (how far inside it one can be, about), and radius, weight and
/// falloff. All for kinds at one moment.
template <class K>
struct DistanceField {
  const K& self() const { return static_cast<const K&>(*this); }

  /// How far from the surface the field reaches, outward and inward. Never 0, so that curves may come down to it.
  double reach() const { return std::max(1e-6, self().radius > 0 ? double(self().radius) : self().inner_radius()); }
  Box3 support() const { return rounded_outward(self().solid_box().padded(self().reach())); }
  /// Whether `potential` counts in thresholds of the shape.
  bool is_in_thresholds() const { return self().falloff == DistanceFalloff::distance; }

  template <class Real>
  Real potential(const Point3<Real>& p) const {
    return double(self().weight) * falloff_at(self().signed_distance(p) * (1 / self().reach()));
  }
  /// The potential of weight 1 at a distance, in reaches.
  template <class Real>
  Real falloff_at(const Real& d) const {
    switch (self().falloff) {
    case DistanceFalloff::distance: return clamp(Real(1.0) - d, 0, 2);
    case DistanceFalloff::quartic: return falloff(Falloff::quartic, square(max(Real(0.0), d)));
    case DistanceFalloff::cubic: return falloff(Falloff::cubic, square(max(Real(0.0), d)));
    case DistanceFalloff::wyvill: return falloff(Falloff::wyvill, square(max(Real(0.0), d)));
    }
    return Real(0.0);
  }
};

inline constexpr std::string_view k_reach_doc = "how far from the surface the field reaches; 0: as far as the solid is thick";
inline constexpr std::string_view k_distance_weight_doc = "a factor of the potential; other than 1 it moves the surface; negative carves";
inline constexpr std::string_view k_distance_falloff_doc =
    "distance: the surface is the solid's; else the solid is a soft skeleton, and `radius` its radius of influence";

/// The signed distance to a box about the origin with rounded edges, in its own coordinates.
template <class Real>
Real distance_to_block(const Point3<Real>& p, const Vec3d& half) {
  const Real x = max(p.x, -p.x) - half.x, y = max(p.y, -p.y) - half.y, z = max(p.z, -p.z) - half.z;
  const Real zero(0.0);
  return norm(norm(max(zero, x), max(zero, y)), max(zero, z)) + min(zero, max(x, max(y, z)));
}

} // namespace kelpie
