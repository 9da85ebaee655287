// The solver for trees, for single rays. Its bounds are those of packets (potentials-inl.h). First one bound for the whole segment, with a
// leaf a lane, rejects most cells; then the root is sought with a stretch of the ray a lane (root_search-inl.h).

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "renderer/trace/solve_tree.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <cmath>

#include "renderer/trace/root_search-inl.h"
#include "renderer/trace/solve.h"
#include "renderer/trace/tree_ray-inl.h"

HWY_BEFORE_NAMESPACE();
namespace kelpie {
namespace HWY_NAMESPACE {

bool SolveTree(const FieldProgram& program, const TreeView& tree, const Cell& cell, const RaySegment& segment, SolverWork& work, float& t) {
  thread_local RayRoom room;
  TreeRay ray(program, tree, cell, segment, room);
  if (!ray.set_up()) return false;
  const auto look_at = [&](V middle, V half) {
    work.evaluations += k_width;
    return ray.look(middle, half);
  };
  // A stretch is a point far below the offset of secondary rays.
  const float least = std::max(1e-4f * cell.epsilon, 2e-7f * std::abs(segment.t1));
  float root;
  if (!RootSearch(look_at, ray.half(), {cell.epsilon, least, 1e-5f * ray.threshold()}).run(root)) return false;
  t = ray.middle() + root;
  return true;
}

} // namespace HWY_NAMESPACE
} // namespace kelpie
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace kelpie {

HWY_EXPORT(SolveTree);

bool solve_given_tree(const FieldProgram& program, const TreeView& tree, const Cell& cell, const RaySegment& ray, SolverWork& work,
                      float& t) {
  return HWY_DYNAMIC_DISPATCH(SolveTree)(program, tree, cell, ray, work, t);
}

bool solve_tree(const ShapeCells& shape, const Cell& cell, const RaySegment& ray, SolverWork& work, float& t) {
  return solve_given_tree(shape.program, shape.tree(cell), cell, ray, work, t);
}

} // namespace kelpie
#endif
