// The range of a skeleton's potential over a box, standing or moving.
#pragma once

#include "base/box.h"
#include "field/kinds.h"
#include "field/motion.h"
#include "field/skeletons/potential.h"

namespace kelpie {

/// A point that ranges over a box, as a function of three variables: coordinates in `p`, those of the middle of the
/// variables' ranges, and how far these reach either way.
struct BoxPoint {
  Point3<Dual<Interval, 3>> p;
  Vec3d centre, half;

  BoxPoint() = default;
  /// The box's own coordinates are the variables.
  explicit BoxPoint(const Box3d& box) : centre(box.centre()), half(box.extent() * 0.5) {
    Dual<Interval, 3>* coordinates[] = {&p.x, &p.y, &p.z};
    for (int i = 0; i < 3; ++i) *coordinates[i] = Dual<Interval, 3>::variable({box.lower[i], box.upper[i]}, i);
  }
};

/// The natural interval extension, met with the mean-value form; in a box that is larger than the skeleton's influence
/// slopes say nothing that values do not.
template <class Kind>
Interval potential_range(const Kind& kind, const BoxPoint& at) {
  if (std::min({at.half.x, at.half.y, at.half.z}) > reach_of(kind))
    return potential(kind, Point3<Interval>{at.p.x.value, at.p.y.value, at.p.z.value});
  const Dual<Interval, 3> f = potential(kind, at.p);
  const double at_centre = potential(kind, Point3<double>{at.centre.x, at.centre.y, at.centre.z});
  const double reach = f.d[0].magnitude() * at.half.x + f.d[1].magnitude() * at.half.y + f.d[2].magnitude() * at.half.z;
  return std::isfinite(reach) ? intersect(f.value, Interval{at_centre - reach, at_centre + reach}) : f.value;
}

/// The same of a signed distance.
template <SignedDistance Kind>
Interval distance_range(const Kind& kind, const BoxPoint& at) {
  const Dual<Interval, 3> d = kind.signed_distance(at.p);
  const double at_centre = kind.signed_distance(Point3<double>{at.centre.x, at.centre.y, at.centre.z});
  const double reach = d.d[0].magnitude() * at.half.x + d.d[1].magnitude() * at.half.y + d.d[2].magnitude() * at.half.z;
  return std::isfinite(reach) ? intersect(d.value, Interval{at_centre - reach, at_centre + reach}) : d.value;
}

inline bool reaches(const Box3& support, double pad, const Box3d& box) {
  return !intersect(Box3d{Vec3d(support.lower) - pad, Vec3d(support.upper) + pad}, box).is_empty();
}

/// Over all states interpolated between two: the distance of the middle one, which differs by no more than the surface moves.
template <SignedDistance Kind>
Interval moving_potential_range(const Kind& a, const Kind& b, const Box3d& box) {
  const Kind middle = interpolated(a, b, 0.5);
  const double moved = std::max(displacement(middle, a, box), displacement(middle, b, box));
  const Interval d = distance_range(middle, BoxPoint(box)) + Interval{-moved, moved};
  // Where a radius is 0 the solid's own counts, which is linear in its numbers.
  Interval reach = hull(a.reach(), b.reach());
  if (a.radius != b.radius) reach = hull(reach, hull(std::max(1e-6f, a.radius), std::max(1e-6f, b.radius)));
  if constexpr (requires { a.most_reach(); }) reach.hi = std::min(reach.hi, a.most_reach());
  return middle.falloff_at(d / reach) * hull(double(a.weight), double(b.weight));
}

/// Over all states interpolated between two: that of the middle, with the largest and the smallest support, seen from as
/// far away as the solid moves.
template <class Kind>
Interval moving_potential_range(const Kind& a, const Kind& b, const Box3d& box) {
  Kind least = interpolated(a, b, 0.5), most = least;
  const double moved = std::max(displacement(least, a, box), displacement(least, b, box));
  least.radius = std::min(a.radius, b.radius), most.radius = std::max(a.radius, b.radius);
  least.weight = most.weight = 1;
  if (!reaches(most.support(), moved, box)) return 0.0;
  const double change = steepest(a.falloff).most * moved / double(least.radius);
  const double lo = potential_range(least, BoxPoint(box)).lo - change, hi = potential_range(most, BoxPoint(box)).hi + change;
  const Box3d padded = box.padded(moved);
  const Interval far = potential(
      most, Point3<Interval>{{padded.lower.x, padded.upper.x}, {padded.lower.y, padded.upper.y}, {padded.lower.z, padded.upper.z}});
  return Interval{std::max(0.0, lo), std::max(0.0, std::min(hi, far.hi))} * hull(double(a.weight), double(b.weight));
}

} // namespace kelpie
