#include "renderer/program/motion.h"
#include "renderer/trace/solve.h"

namespace kelpie {

bool solve_moving_tree(const ShapeCells& shape, const Cell& cell, const RaySegment& ray, SolverWork& work, float& t) {
  const CodeView code = shape.code(cell);
  const FieldProgram& now = at(shape.program, code, shape.slab_time(ray.time));
  thread_local Tree tree; // its room stays
  return make_tree(now, code, cell.box, cell.centre, tree) ? solve_given_tree(now, tree.view(), cell, ray, work, t)
                                                           : solve_code(shape, cell, ray, work, t);
}

} // namespace kelpie
