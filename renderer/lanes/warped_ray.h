// A ray in the warped spaces of a tree, a curve in each.
#pragma once

#include "renderer/lanes/tree_view.h"
#include "renderer/program/evaluate.h"

namespace kelpie {

class WarpedRay {
public:
  /// A place on the curve, from the space's centre, and the derivative by t.
  struct Place {
    Vec3 at, velocity;
  };

  WarpedRay(const FieldProgram& program, std::span<const TreeSpace> spaces) : program_(program), spaces_(spaces) {}

  /// Where the ray is at t in a space, by the formula of every warp on the way.
  Place find(const Vec3& origin, const Vec3& direction, double t, size_t index) const {
    using D = Dual<double, 1>;
    thread_local SpacePoints<D> points;
    points.begin(program_);
    const auto coordinate = [&](int i) { return D{double(origin[i]) + t * double(direction[i]), {double(direction[i])}}; };
    const Point3<D> world{coordinate(0), coordinate(1), coordinate(2)};
    const Point3<D>& p = points.at(program_, spaces_[index].space, world);
    return {Vec3(Vec3d(p.x.value, p.y.value, p.z.value) - Vec3d(spaces_[index].centre)), Vec3(p.x.d[0], p.y.d[0], p.z.d[0])};
  }

  size_t count() const { return spaces_.size(); }

private:
  const FieldProgram& program_;
  std::span<const TreeSpace> spaces_;
};

} // namespace kelpie
