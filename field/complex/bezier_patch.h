// Bicubic Bezier patches.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "base/box.h"
#include "field/complex/thick_surface.h"

namespace kelpie {

/// 4 by 4 control points, row after row; w: half the thickness.
class BezierPatch {
public:
  static constexpr size_t k_points = 16;
  enum Side { bottom, top, left, right, k_sides }; ///< v = 0, v = 1, u = 0, u = 1; u runs along the rows

  explicit BezierPatch(std::span<const glm::dvec4, k_points> points) { std::copy(points.begin(), points.end(), points_.begin()); }

  SurfacePoint at(double u, double v) const;
  Box3d box() const;
  /// Bounds of second derivatives, place and thickness together: by u and u, u and v, v and v.
  struct Bends {
    double uu, uv, vv;
  };
  Bends bends() const;

  /// The control points of a border, in the order of rising u or v.
  std::array<glm::dvec4, 4> border(Side) const;
  /// A place of a border, s in [0, 1].
  SurfacePoint on_border(Side, double s) const;

private:
  glm::dvec4 point(size_t column, size_t row) const { return points_[4 * row + column]; }

  std::array<glm::dvec4, k_points> points_;
};

/// Whether two patches meet along a border without a crease: the same border, run through either way, and the same tangent planes.
bool is_smooth(const BezierPatch& a, BezierPatch::Side, const BezierPatch& b, BezierPatch::Side);

} // namespace kelpie
