// Several axes together: where a point of the deformed space is in the rest space.
#pragma once

#include <span>

#include "base/box.h"
#include "base/dual.h"
#include "field/warps/axis_shape.h"

namespace kelpie {

class AxisTube;
struct AxisPiece;

class AxialMap {
public:
  using Slopes = Dual<double, 3>;
  using Range = Dual<Interval, 3>;

  explicit AxialMap(std::span<const AxisShape>);
  ~AxialMap();
  AxialMap(const AxialMap&) = delete;

  Point3<double> rest(const Point3<double>&) const;
  /// With the derivatives by x, y and z.
  Point3<Slopes> rest_with_slopes(const Vec3d&) const;
  /// Bounds over a box; of slopes too, which are as good as unbounded where the map jumps.
  Point3<Range> rest_of(const Box3d&) const;
  /// Whether the map may jump in a box; then `images` are boxes around all places where the box goes, but for what is nowhere.
  bool torn_images(const Box3d&, std::vector<Box3d>&) const;

  /// Whether one axis alone acts on all points of a box, or none: then its pieces (AxisTube::pieces).
  bool alone(const Box3d&, double tolerance, std::vector<AxisPiece>&) const;

  /// A point that `rest` takes to q, if there is one.
  Point3<double> deformed(const Point3<double>& q) const;
  /// Around all points that `rest` takes into a box.
  Box3d image_of(const Box3d&) const;

  const std::vector<AxisTube>& tubes() const { return tubes_; }

private:
  template <class Real>
  struct Offer;
  class BoxOffers;
  template <class Real>
  void collect(const Vec3d& p, std::vector<Offer<Real>>&) const;
  template <class Real>
  Point3<Real> join(const Point3<Real>& p, const Vec3d& at) const;
  bool is_vacated(const Vec3d& p) const;
  bool bound(const Box3d&, Point3<Range>&, std::vector<Box3d>* images) const;

  std::vector<AxisTube> tubes_; ///< none where nothing is moved
  double nowhere_ = 1;          ///< how far away, along x, what is nowhere is sent
};

} // namespace kelpie
