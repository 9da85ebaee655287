// A ray in the warped spaces of a tree, a curve in each; and gradients from there.
#pragma once

#include "renderer/cells/cells.h"

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

/// A point in the spaces of a tree, and how gradients get from there to the world.
class SpaceGradients {
public:
  SpaceGradients(const FieldProgram& program, const TreeView& tree, const Cell& cell, const Vec3& place) : world_(place - cell.centre) {
    using D = Dual<double, 3>;
    if (tree.spaces.empty()) return;
    thread_local SpacePoints<D> points;
    points.begin(program);
    const Point3<D> world{D::variable(place.x, 0), D::variable(place.y, 1), D::variable(place.z, 2)};
    for (const TreeSpace& space : tree.spaces) {
      const Point3<D>& p = points.at(program, space.space, world);
      warped_.push_back(
          {Vec3(Vec3d(p.x.value, p.y.value, p.z.value) - Vec3d(space.centre)), {gradient(p.x), gradient(p.y), gradient(p.z)}});
    }
  }

  /// The point, from the cell's centre, in the space of a leaf's number `leaf_space`.
  const Vec3& place(float slot) const { return slot == 0 ? world_ : warped_[static_cast<size_t>(slot) - 1].place; }
  Vec3 in_world(float slot, const Vec3& g) const {
    if (slot == 0) return g;
    const auto& by = warped_[static_cast<size_t>(slot) - 1].gradients;
    return g.x * by[0] + g.y * by[1] + g.z * by[2];
  }

private:
  struct Warped {
    Vec3 place;
    std::array<Vec3, 3> gradients; ///< of its coordinates
  };
  static Vec3 gradient(const Dual<double, 3>& x) { return Vec3(x.d[0], x.d[1], x.d[2]); }

  Vec3 world_;
  std::vector<Warped> warped_;
};

} // namespace kelpie
