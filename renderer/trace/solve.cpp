#include "renderer/trace/solve.h"

namespace kelpie {

bool solve(const ShapeCells& shape, const Cell& cell, const RaySegment& ray, SolveCounters& counters, float& t) {
  ++counters.cells;
  return cell.content == Cell::Content::code ? solve_code(shape, cell, ray, counters, t) : solve_blobs(shape, cell, ray, counters, t);
}

Vec3 cell_gradient(const ShapeCells& shape, const Cell& cell, const Vec3& p) {
  if (cell.content != Cell::Content::code) return blobs_gradient(shape, cell, p);
  return Vec3(gradient(shape.program, shape.code(cell), Vec3d(p)));
}

} // namespace kelpie
