#include "renderer/program/surface_search.h"

#include <algorithm>

#include "base/error.h"

namespace kelpie {

namespace {

void extend_by_surface(const FieldProgram& program, const Code& parent, const Box3d& box, double side, Box3d& out) {
  if (out.contains(box.lower) && out.contains(box.upper)) return; // it would not extend it
  Interval field;
  const Code code = code_in(program, parent, box, field);
  if (is_empty(field, program.threshold)) return;
  const Vec3d extent = box.extent();
  const int longest = extent.x >= extent.y && extent.x >= extent.z ? 0 : extent.y >= extent.z ? 1 : 2;
  if (extent[longest] <= side || is_full(field, program.threshold)) {
    out.extend(box);
    return;
  }
  Box3d lower = box, upper = box;
  lower.upper[longest] = upper.lower[longest] = box.centre()[longest];
  extend_by_surface(program, code, lower, side, out);
  extend_by_surface(program, code, upper, side, out);
}

} // namespace

Code code_in(const FieldProgram& program, const Code& parent, const Box3d& box, Interval& field) {
  std::vector<Interval> ranges;
  Code code = bound(program, parent, box, ranges);
  field = ranges.back();
  return code.steps.size() == 1 ? code : prune(program, code, ranges, Demand::value);
}

Box3d surface_bounds(const FieldProgram& program, int resolution) {
  Box3d box = program.support;
  if (box.is_empty()) return box;
  constexpr double k_endless = 1e6;
  const auto largest = [](const Vec3d& v) { return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}); };
  if (!(largest(box.lower) < k_endless && largest(box.upper) < k_endless))
    throw Error(ExitStatus::bad_data, "a shape without an end cannot be measured");
  // From coarse to fine, so that a small surface in a wide support is found as exactly as a large one.
  for (int round = 0; round < 2; ++round) {
    const Vec3d extent = box.extent();
    Box3d found;
    extend_by_surface(program, program.code, box, std::max({extent.x, extent.y, extent.z}) / resolution, found);
    if (found.is_empty()) return found;
    box = intersect(box, found);
  }
  return box;
}

} // namespace kelpie
