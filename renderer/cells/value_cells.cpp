#include "renderer/cells/value_cells.h"

#include <deque>

#include "renderer/cells/element_size.h"
#include "renderer/program/bound.h"

namespace kelpie {

namespace {

/// So few elements are not worth a search, and boxes smaller than so many radii of influence hold no fewer.
constexpr size_t k_few_elements = 6;
constexpr double k_least_side = 0.5;
/// All codes together take no more; larger boxes are as right.
constexpr size_t k_most_bytes = size_t(128) << 20;

/// A node whose box is still to be looked at, with what matters in the box around it.
struct Pending {
  uint32_t node;
  Box3d box;
  Code code;
};

size_t bytes_of(const Code& code) {
  return sizeof(Code) + code.steps.size() * sizeof(Instruction) + (code.operands.size() + code.blobs.size()) * sizeof(uint32_t);
}

int longest_axis(const Box3d& box) {
  const Vec3d extent = box.extent();
  return extent.x >= extent.y && extent.x >= extent.z ? 0 : extent.y >= extent.z ? 1 : 2;
}

} // namespace

ValueCells::ValueCells(FieldProgram program, const Box3d& bounds) : program_(std::move(program)) {
  box_ = intersect(program_.support, bounds);
  if (!box_.is_empty()) build();
}

CodeView ValueCells::code_at(const Vec3d& p) const {
  if (!program_.support.contains(p)) return {};
  if (!box_.contains(p)) return program_.code;
  const Node* node = &nodes_[0];
  while (node->axis >= 0) node = &nodes_[p[node->axis] < node->middle ? node->lower : node->upper];
  return codes_[node->lower];
}

/// All boxes of a size before any smaller one, so that where memory ends all are about as small.
void ValueCells::build() {
  nodes_.emplace_back();
  std::deque<Pending> pending;
  pending.push_back({0, box_, program_.code});
  size_t bytes = bytes_of(program_.code);
  while (!pending.empty()) {
    const Pending whole = std::move(pending.front());
    pending.pop_front();
    std::vector<Interval> ranges;
    Code code = bound(program_, whole.code, whole.box, ranges);
    if (code.steps.size() > 1) code = prune(program_, code, ranges, Demand::value);
    bytes -= bytes_of(whole.code);
    const int axis = longest_axis(whole.box);
    const bool is_small =
        element_count(code) <= k_few_elements || whole.box.extent()[axis] <= k_least_side * smallest_radius(program_, code);
    if (is_small || bytes + 2 * bytes_of(code) > k_most_bytes) {
      nodes_[whole.node].lower = static_cast<uint32_t>(codes_.size());
      bytes += bytes_of(code);
      codes_.push_back(std::move(code));
      continue;
    }
    bytes += 2 * bytes_of(code);
    const double middle = whole.box.centre()[axis];
    Box3d lower = whole.box, upper = whole.box;
    lower.upper[axis] = upper.lower[axis] = middle;
    const auto first = static_cast<uint32_t>(nodes_.size());
    nodes_.resize(nodes_.size() + 2);
    nodes_[whole.node] = {axis, middle, first, first + 1};
    pending.push_back({first, lower, code});
    pending.push_back({first + 1, upper, std::move(code)});
  }
}

} // namespace kelpie
