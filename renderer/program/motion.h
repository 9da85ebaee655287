// Programs that move: what becomes of a compiled field over a slab of time.
#pragma once

#include <tbb/enumerable_thread_specific.h>

#include "field/motion.h"
#include "renderer/program/evaluate.h"

namespace kelpie {

/// A slab of time, u from 0 to 1: every compiled number of a program (centres, radii and weights of blobs as x y z k a b;
/// affine maps of spaces; the numbers of the nodes; the threshold) is interpolated linearly between both ends.
struct Motion {
  FieldProgram end;                                          ///< at u = 1
  SampledField middle;                                       ///< the nodes at u = 1/2
  bool blobs_change = false;                                 ///< whether more of blobs than their centres moves
  std::vector<char> nodes;                                   ///< whether each moves
  std::vector<char> spaces;                                  ///< whether each moves, or one that it lies in
  mutable tbb::enumerable_thread_specific<FieldProgram> now; ///< what at() returns
};

/// Sets `start` in motion towards `end`, compiled together with it; where nothing moves it stays as it is. Warps that are no
/// MovingWarp stand as `held` has them, a moment compiled with both. False, and it stays too, if spaces turn or shrink so much that
/// not all interpolated maps can be inverted.
bool set_in_motion(FieldProgram& start, FieldProgram end, const SampledField* held = nullptr);

/// The program at time u, without its code. Of its nodes and spaces only those that the code needs are good, and only until this thread
/// calls again for the same program; its blobs are those of `program`, on their way.
const FieldProgram& at(const FieldProgram&, const CodeView&, double u);

/// The same, of a program with identities; the spaces in which the materials of the code's leaves live are good, too.
const FieldProgram& at_with_materials(const FieldProgram&, const CodeView&, double u);

/// Around the image of a box of the world in a space, at all times.
Box3d image_in_space(const FieldProgram&, uint32_t space, const Box3d&);

inline Affine interpolate(const Affine& a, const Affine& b, double u) {
  return {a.linear + (b.linear - a.linear) * u, a.offset + (b.offset - a.offset) * u};
}

/// How far a moving warp may take points of a box from where its middle state takes them.
template <class Kind>
Vec3d displacement(const Kind& middle, const Kind& a, const Kind& b, const Box3d& box, WarpWay way) {
  if constexpr (MovingWarp<Kind>)
    if (!is_same(a, b)) return glm::max(middle.displacement_from(a, box, way), middle.displacement_from(b, box, way));
  return Vec3d(0);
}
inline Box3d grown(const Box3d& box, const Vec3d& by) { return {box.lower - by, box.upper + by}; }

inline Interval threshold_range(const FieldProgram& p) {
  return p.motion ? hull(p.threshold, p.motion->end.threshold) : Interval{p.threshold};
}
inline double threshold_at(const FieldProgram& p, double u) {
  return p.motion ? p.threshold + (p.motion->end.threshold - p.threshold) * u : p.threshold;
}

/// What a program and its motion take, about: without what its nodes share with the scene, and the copies of nodes that threads make of
/// what moves.
size_t program_bytes(const FieldProgram&);

/// How far two programs of one structure are apart, of which `b` has its code. To choose slabs by: warps are looked at in a few places
/// only.
struct ProgramDifference {
  double place = 0; ///< of elements, in radii of influence, in the spaces where they live: of all but the farthest 2 %
  double most = 0;  ///< the same, of all; and what is no place, relative
};
ProgramDifference difference(const FieldProgram&, const FieldProgram&);

} // namespace kelpie
