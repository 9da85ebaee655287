#pragma once

#include <memory>

#include "base/kind.h"
#include "field/warps/axial_map.h"

namespace kelpie {

template <>
struct EnumNames<FrameInterpolation> {
  static constexpr std::array<std::pair<std::string_view, FrameInterpolation>, 2> values{
      {{"cosine", FrameInterpolation::cosine}, {"linear", FrameInterpolation::linear}}};
};

/// A frame of an axis that the user turns.
template <class Mode>
struct AxialFrame {
  static constexpr std::string_view k_name = "axial_frame";
  static constexpr std::string_view k_doc = "A place of an `axial` axis where what lies around the axis is turned about it.";

  float at = 1;
  Value<Mode, float> angle{0.f};

  static constexpr auto parameters() {
    return std::tuple{
        parameter("at", &AxialFrame::at, "where: a part of the length of the rest axis").at_least(0).at_most(1).required(),
        parameter("angle", &AxialFrame::angle, "how far it is turned about the axis, right-handed").in(Unit::degrees).required(),
    };
  }
  friend bool operator==(const AxialFrame&, const AxialFrame&) = default;
};

template <class Mode>
struct AxialAxis {
  static constexpr std::string_view k_name = "axial_axis";
  static constexpr std::string_view k_doc =
      R"(An axis of an `axial` deformation: a clamped uniform B-spline at rest, and the same spline where it goes.

The region of influence is a tube of the given radius around the axis, with round ends.)";

  std::vector<Value<Mode, Vec3>> rest, deformed;
  int degree = 3;
  Vec3 normal{0.f};
  std::vector<AxialFrame<Mode>> frames;
  FrameInterpolation interpolation = FrameInterpolation::cosine;
  float radius = 1, border = 0.25;

  static constexpr auto parameters() {
    return std::tuple{
        parameter("rest", &AxialAxis::rest, "control points of the axis as the child has it").in(Unit::length).of_at_least(2).required(),
        parameter("deformed", &AxialAxis::deformed, "where the control points go: as many; each may be animated")
            .in(Unit::length)
            .of_at_least(2)
            .required(),
        parameter("degree", &AxialAxis::degree, "of the spline; fewer points than degree + 1 lower it").at_least(1).at_most(3),
        parameter("normal", &AxialAxis::normal,
                  "the first normal of the rest axis, of which only what is across the axis counts; [0, 0, 0]: the projected y axis"),
        parameter("frames", &AxialAxis::frames, "frames that are turned; the ends are not turned unless they are among them"),
        parameter("interpolation", &AxialAxis::interpolation,
                  "of angles between frames, by the length of the rest axis: `cosine` is smooth at frames, `linear` has corners there"),
        parameter("radius", &AxialAxis::radius, "of the tube that goes with the axis").in(Unit::length).above(0).required(),
        parameter("border", &AxialAxis::border, "the outer part of the radius over which the influence fades").above(0).at_most(1),
    };
  }
  friend bool operator==(const AxialAxis&, const AxialAxis&) = default;
};

template <class Mode>
struct Axial {
  static constexpr std::string_view k_name = "axial";
  static constexpr std::string_view k_doc =
      R"(Deforms its child by axes: what lies around a curve goes with the curve when that is moved, bent, stretched or rolled.

    f(p) = f_child(r(t) + u x_r(t) + v y_r(t) + w z_r(t))
    t: the place of the deformed axis c that is nearest to p;   (u, v, w) = p - c(t) in the frame (x, y, z) of c there

r is the rest axis, with the same t. z is the direction of the axis; normals y go along both axes without turning about them
(normal plane projection in the limit of short steps), and the `frames` of the user roll those of the deformed axis. w is 0 except
beyond the ends of an axis, where space goes rigidly with the end.

The region of influence of an axis is a tube; in its border the influence fades to nothing. Where tubes meet, each axis has a share,
together no more than all. This joins what moves alike: the root of an arm that stays, and the body around it. What moves by more
than a third of the border's width is not joined but torn: a point belongs to the axis in whose tube it lies deepest, and where an
axis has left, nothing remains. So let tubes be wide enough for the whole limb, borders and all.

A tube is cut before space would fold in it: where either axis bends, to nine tenths of its radius of curvature, and where it comes near
itself, so that every point has one nearest place. `kelpie check` and `render` warn of it.

While the shutter is open it is stepped: what it deforms is seen at up to 32 moments of the shutter, not in between.
Source: Chow, Hui 2008, "Axial deformation with controllable local coordinate frames"; methods.md section 4.)";

  std::vector<AxialAxis<Mode>> axes;
  typename Mode::Child child{};
  /// Made of the axes by `prepare`, once for each moment.
  std::shared_ptr<const AxialMap> map;

  static constexpr auto parameters() {
    return std::tuple{
        parameter("axes", &Axial::axes, "the axes").required(),
        parameter("child", &Axial::child, "the field to deform").required(),
    };
  }

  // Sampled:

  void prepare() {
    std::vector<AxisShape> shapes;
    for (const AxialAxis<Mode>& axis : axes) shapes.push_back(shape(axis));
    map = std::make_shared<const AxialMap>(shapes);
  }

  static AxisShape shape(const AxialAxis<Mode>& axis) {
    AxisShape out;
    out.rest.assign(axis.rest.begin(), axis.rest.end()), out.deformed.assign(axis.deformed.begin(), axis.deformed.end());
    out.degree = axis.degree, out.normal = Vec3d(axis.normal), out.interpolation = axis.interpolation;
    for (const AxialFrame<Mode>& f : axis.frames) out.frames.push_back({double(f.at), glm::radians(double(f.angle))});
    out.radius = double(axis.radius), out.border = double(axis.border);
    return out;
  }

  Point3<double> child_from_parent(const Point3<double>& p) const { return map->rest(p); }
  Point3<Interval> child_from_parent(const Point3<Interval>& p) const {
    const Point3<AxialMap::Range> r = map->rest_of(box_of(p));
    return {r.x.value, r.y.value, r.z.value};
  }
  template <int N>
  Point3<Dual<double, N>> child_from_parent(const Point3<Dual<double, N>>& p) const {
    return chained(map->rest_with_slopes({p.x.value, p.y.value, p.z.value}), p);
  }
  template <int N>
  Point3<Dual<Interval, N>> child_from_parent(const Point3<Dual<Interval, N>>& p) const {
    return chained(map->rest_of(box_of(Point3<Interval>{p.x.value, p.y.value, p.z.value})), p);
  }

  bool torn_images(const Box3d& box, std::vector<Box3d>& images) const { return map->torn_images(box, images); }

  bool alone(const Box3d& box, double tolerance, std::vector<AxisPiece>& pieces) const { return map->alone(box, tolerance, pieces); }

  Point3<double> parent_from_child(const Point3<double>& p) const { return map->deformed(p); }
  Box3d image_of(const Box3d& box) const { return map->image_of(box); }

private:
  static Box3d box_of(const Point3<Interval>& p) { return {{p.x.lo, p.y.lo, p.z.lo}, {p.x.hi, p.y.hi, p.z.hi}}; }

  /// The chain rule, from derivatives by the point's coordinates.
  template <class T, int N>
  static Point3<Dual<T, N>> chained(const Point3<Dual<T, 3>>& outer, const Point3<Dual<T, N>>& inner) {
    const auto one = [&](const Dual<T, 3>& r) {
      Dual<T, N> out;
      out.value = r.value;
      for (int i = 0; i < N; ++i) out.d[i] = r.d[0] * inner.x.d[i] + r.d[1] * inner.y.d[i] + r.d[2] * inner.z.d[i];
      return out;
    };
    return {one(outer.x), one(outer.y), one(outer.z)};
  }
};

} // namespace kelpie
