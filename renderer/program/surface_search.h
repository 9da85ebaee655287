// Where a program has its surface: boxes that are proved to be beside it, and the place on a line.
#pragma once

#include "renderer/program/bound.h"

namespace kelpie {

/// A box is empty or full only by this part of the threshold: blobs are bounded in float.
inline constexpr double k_bound_margin = 1e-5;

/// Whether the surface proves to be outside of a box over which the field lies in `field`, which is then all outside (empty) or inside.
inline bool is_empty(const Interval& field, double threshold) { return field.hi < threshold * (1 - k_bound_margin); }
inline bool is_full(const Interval& field, double threshold) { return field.lo > threshold * (1 + k_bound_margin); }

/// What of a program matters in a box, for values; `field` receives its range there.
Code code_in(const FieldProgram& program, const Code& parent, const Box3d& box, Interval& field);

/// How far the field is above the threshold.
inline double excess(const FieldProgram& program, const CodeView& code, const Vec3d& p) {
  return evaluate(program, code, Point3<double>{p.x, p.y, p.z}) - program.threshold;
}

/// Which part of the way from a point inside to one outside it is to where `excess(part)` is 0, by the Illinois variant of the false
/// position. `inner` > 0 and `outer` <= 0 are the excesses at both; it is found once the excess is no more than `close`.
template <class Excess>
double crossing(double inner, double outer, double close, Excess&& excess) {
  constexpr int k_rounds = 8;
  double s = 0, t = 1, middle = 0.5;
  int side = 0;
  for (int round = 0; round < k_rounds; ++round) {
    middle = (s * outer - t * inner) / (outer - inner);
    const double f = excess(middle);
    if (std::abs(f) <= close) break;
    if (f > 0) {
      s = middle, inner = f;
      if (side == 1) outer /= 2;
      side = 1;
    } else {
      t = middle, outer = f;
      if (side == -1) inner /= 2;
      side = -1;
    }
  }
  return middle;
}

/// A box around all places where the field may exceed its threshold, too large by less than 2 / `resolution` of its longest side on each;
/// empty where it is proved that there are none. Throws Error, bad_data, where the field has no end.
Box3d surface_bounds(const FieldProgram&, int resolution = 40);

} // namespace kelpie
