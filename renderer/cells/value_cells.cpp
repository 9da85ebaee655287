#include "renderer/cells/value_cells.h"

#include "renderer/cells/element_size.h"
#include "renderer/program/bound.h"

namespace kelpie {

namespace {

/// So few elements are not worth a search, and boxes smaller than so many radii of influence hold no fewer.
constexpr size_t k_few_elements = 6;
constexpr double k_least_side = 0.5;
constexpr int k_most_depth = 30;

} // namespace

ValueCells::ValueCells(FieldProgram program, const Box3d& bounds) : program_(std::move(program)) {
  box_ = intersect(program_.support, bounds);
  if (!box_.is_empty()) build(box_, program_.code, 0);
}

CodeView ValueCells::code_at(const Vec3d& p) const {
  if (!program_.support.contains(p)) return {};
  if (!box_.contains(p)) return program_.code;
  const Node* node = &nodes_[0];
  while (node->axis >= 0) node = &nodes_[p[node->axis] < node->middle ? node->lower : node->upper];
  return codes_[node->lower];
}

uint32_t ValueCells::build(const Box3d& box, const Code& parent, int depth) {
  std::vector<Interval> ranges;
  Code code = bound(program_, parent, box, ranges);
  if (code.steps.size() > 1) code = prune(program_, code, ranges, Demand::value);
  const auto at = static_cast<uint32_t>(nodes_.size());
  nodes_.emplace_back();
  const Vec3d extent = box.extent();
  const int axis = extent.x >= extent.y && extent.x >= extent.z ? 0 : extent.y >= extent.z ? 1 : 2;
  if (element_count(code) <= k_few_elements || depth >= k_most_depth || extent[axis] <= k_least_side * smallest_radius(program_, code)) {
    nodes_[at].lower = static_cast<uint32_t>(codes_.size());
    codes_.push_back(std::move(code));
    return at;
  }
  const double middle = box.centre()[axis];
  Box3d lower = box, upper = box;
  lower.upper[axis] = upper.lower[axis] = middle;
  const uint32_t first = build(lower, code, depth + 1), second = build(upper, code, depth + 1);
  nodes_[at] = {axis, middle, first, second};
  return at;
}

} // namespace kelpie
