#pragma once

#include "field/falloff.h"
#include "field/skeletons/frame.h"

namespace kelpie {

/// The signed distance to a cone-sphere, in its plane of symmetry: y >= 0 from the axis, z along it from the
/// first centre. With the balls of the family at s in [0, length], of radius r(s) = first - sine * s, it is
///   min over s of |(y, z - s)| - r(s),   reached at s = clamp(z - y * sine / cosine, 0, length).
/// Convex, and rising with y; so its range over a rectangle is known from its corners.
struct ConeSphereProfile {
  double length, first, sine, slope; ///< slope: sine / cosine of the cone's half angle

  /// One ball that contains the other is all there is: length 0.
  ConeSphereProfile(double length_, double first_radius, double second_radius) : length(length_), first(first_radius), sine(0), slope(0) {
    if (length <= std::abs(first_radius - second_radius)) {
      lift = first_radius >= second_radius ? 0 : length;
      first = std::max(first_radius, second_radius), length = 0;
    } else {
      sine = (first_radius - second_radius) / length;
      slope = sine / std::sqrt((1 - sine) * (1 + sine));
    }
  }

  double nearest(double y, double z) const { return std::min(std::max(z - y * slope, 0.0), length); }
  double distance(double y, double z) const {
    z -= lift;
    const double s = nearest(y, z);
    return norm(y, z - s) - (first - sine * s);
  }
  /// The derivative by z: that by y is sqrt(1 - its square).
  double rise(double y, double z) const {
    z -= lift;
    const double s = nearest(y, z);
    return s > 0 && s < length ? sine : cosine(z - s, y);
  }
  /// Where along the axis the distance is least, for every y.
  double lowest() const { return lift + (sine >= 0 ? 0 : length); }

  double lift = 0; ///< where along the axis the first ball of the family is
};

inline double distance(const ConeSphereProfile& c, double y, double z) { return c.distance(y, z); }
inline Interval distance(const ConeSphereProfile& c, Interval y, Interval z) {
  return {c.distance(y.lo, std::min(std::max(c.lowest(), z.lo), z.hi)), std::max(c.distance(y.hi, z.lo), c.distance(y.hi, z.hi))};
}
inline double rise(const ConeSphereProfile& c, double y, double z) { return c.rise(y, z); }
/// By convexity the derivative rises with z; for each z it is monotone in y. At the centre of a ball it jumps.
inline Interval rise(const ConeSphereProfile& c, Interval y, Interval z) {
  if (y.lo <= 0 && z.lo <= c.lift + c.length && z.hi >= c.lift) return {-1, 1};
  return {std::min(c.rise(y.lo, z.lo), c.rise(y.hi, z.lo)), std::max(c.rise(y.lo, z.hi), c.rise(y.hi, z.hi))};
}
template <class T, int N>
Dual<T, N> distance(const ConeSphereProfile& c, const Dual<T, N>& y, const Dual<T, N>& z) {
  Dual<T, N> r;
  r.value = distance(c, y.value, z.value);
  const T by_z = rise(c, y.value, z.value), by_y = sqrt(max(T(0.0), T(1.0) - square(by_z)));
  for (int i = 0; i < N; ++i) r.d[i] = by_y * y.d[i] + by_z * z.d[i];
  return r;
}

template <class Mode>
struct ConeSphere {
  static constexpr std::string_view k_name = "cone_sphere";
  static constexpr std::string_view k_doc =
      R"(The potential around a solid cone-sphere: two balls and the cone that touches both. A capsule if they are equal.

    f(p) = weight * falloff(d(p)^2 / radius^2),   d the Euclidean distance to the solid, 0 inside it

The distance is exact: that to the nearest of the balls around the points between the two centres, whose radii
change linearly from `from_radius` to `to_radius`. Simpler shapes are reached without a jump: equal radii make a
line-swept sphere, radii of 0 a `segment`, equal centres or a ball inside the other the larger ball. Limbs are
chains of cone-spheres. Source: methods.md section 2, skeletons.)";

  Value<Mode, Vec3> from{Vec3(0)};
  Value<Mode, Vec3> to{Vec3(0, 1, 0)};
  Value<Mode, float> from_radius{0.f};
  Value<Mode, float> to_radius{0.f};
  Value<Mode, float> radius{1.f};
  Value<Mode, float> weight{1.f};
  Falloff falloff = Falloff::quartic;

  static constexpr auto parameters() {
    return std::tuple{
        parameter("from", &ConeSphere::from, "the centre of the first ball").in(Unit::length).required(),
        parameter("to", &ConeSphere::to, "the centre of the second ball").in(Unit::length).required(),
        parameter("from_radius", &ConeSphere::from_radius, "the radius of the first ball").in(Unit::length).at_least(0).required(),
        parameter("to_radius", &ConeSphere::to_radius, "the radius of the second ball").in(Unit::length).at_least(0).required(),
        parameter("radius", &ConeSphere::radius, "radius of influence, from the solid's surface: the potential is 0 beyond it")
            .in(Unit::length)
            .above(0)
            .required(),
        parameter("weight", &ConeSphere::weight, "the potential in the solid; negative carves"),
        parameter("falloff", &ConeSphere::falloff, "how the potential decreases"),
    };
  }

  // Sampled:

  ConeSphereSolid solid() const { return {Vec3d(from), Vec3d(to), from_radius, to_radius}; }

  Box3 support() const {
    const double a = double(from_radius) + double(radius), b = double(to_radius) + double(radius);
    Box3d box{Vec3d(from) - a, Vec3d(from) + a};
    box.extend(Box3d{Vec3d(to) - b, Vec3d(to) + b});
    return rounded_outward(box);
  }

  /// How far the solid moves between two states, and any two states interpolated between them.
  double displacement_from(const ConeSphere& other) const {
    return std::max(glm::distance(Vec3d(from), Vec3d(other.from)) + std::abs(double(from_radius) - double(other.from_radius)),
                    glm::distance(Vec3d(to), Vec3d(other.to)) + std::abs(double(to_radius) - double(other.to_radius)));
  }

  template <class Real>
  Real potential(const Point3<Real>& p) const {
    const Vec3d axis = Vec3d(to) - Vec3d(from);
    const AxisFrame frame{Vec3d(from), axis};
    const ConeSphereProfile profile{glm::length(axis), from_radius, to_radius};
    const Point3<Real> q = frame.local(p);
    const Real d = max(Real(0.0), distance(profile, norm(q.x, q.y), q.z));
    return double(weight) * kelpie::falloff(falloff, square(d) * (1 / square(double(radius))));
  }
};

} // namespace kelpie
