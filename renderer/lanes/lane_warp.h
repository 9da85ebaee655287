// Warps as the solvers of trees compute them in SIMD lanes: where a place goes, relative to where the centre of the cell goes.
#pragma once

#include <limits>

#include "base/box.h"
#include "field/kinds.h"

namespace kelpie {

/// A warp about a place c, by differences: float numbers are as exact in it as the cell is small, wherever the cell lies.
/// With p = from d in the frame of the warp, d the place from c in the parent space, the image is
///   back(difference(p)) + shift   from the centre of the space;
/// what `difference` is depends on the form. (x, y, z) is c in the frame.
struct LaneWarp {
  enum class Form : uint32_t { none, twist, taper, bend, axial };
  Form form = Form::none; ///< none: this kind has no such form, and is computed point by point
  float from[9];          ///< rows
  float back[9];          ///< rows; of a twist turned as c is
  float shift[3];
  float x, y;
  /// Of twist and taper: the height that acts, clamped, less that of c, is clamp(ahead + p.z, low, high).
  float ahead = 0, low = -std::numeric_limits<float>::infinity(), high = std::numeric_limits<float>::infinity();
  float rate = 0;   ///< of a twist: radians per length; of a taper: change of the factor
  float factor = 1; ///< of a taper: at c
  /// Of a bend, seen from its axis: across towards the line, and along; the distance of the line and of c, and the angles of c
  /// and of the end. What is before the arc, in it and beyond its end is moved by (offset_x, offset_z).
  float across, along, line, distance, angle, end, cosine, sine;
  float offset_x[3], offset_z[3];
  /// Of an axial deformation: which pieces of an axis act in the cell; none: nothing is moved.
  uint32_t first_piece = 0, piece_count = 0;
};

/// A piece of the axis of an axial deformation (AxisPiece), with what the solvers need beforehand. Numbers of powers of u are one
/// after the other.
struct LaneAxis {
  float low, high, joint;
  float offset[3], along; ///< along: offset c'(0)
  float axis[3][3];       ///< from the first power on
  float squares[5];       ///< dc c', from the first power on
  float shift[3][3];      ///< from the first power on
  float turn[5][9];       ///< rows
  float constant[3];      ///< where the middle goes if its place is c(0), from the image of the cell's centre
  int newton_steps;
};

/// About `centre` in the parent space; the warp is kind(local_from_parent(p)), and images count from `image`. For kinds that have no
/// such form it is `none`.
template <class Kind>
LaneWarp lane_warp(const Kind&, const Affine& /*local_from_parent*/, const Vec3d& /*centre*/, const Vec3d& /*image*/) {
  return {};
}
LaneWarp lane_warp(const Twist<SampledMode>&, const Affine& local_from_parent, const Vec3d& centre, const Vec3d& image);
LaneWarp lane_warp(const Taper<SampledMode>&, const Affine& local_from_parent, const Vec3d& centre, const Vec3d& image);
LaneWarp lane_warp(const Bend<SampledMode>&, const Affine& local_from_parent, const Vec3d& centre, const Vec3d& image);
/// Appends to `pieces`. `box`: around the cell, in the space of the axes.
LaneWarp lane_warp(const Axial<SampledMode>&, const Affine& local_from_parent, const Vec3d& centre, const Vec3d& image, const Box3d& box,
                   std::vector<LaneAxis>& pieces);

} // namespace kelpie
