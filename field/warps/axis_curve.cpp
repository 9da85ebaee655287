#include "field/warps/axis_curve.h"

#include <nanoflann.hpp>

#include "field/warps/axis_work.h"

namespace kelpie {

namespace {

constexpr size_t k_tube_samples = 128;
constexpr double k_lattice_cells = 4096;
constexpr size_t k_group = 8; ///< steps
/// Of the angle by which a part of the axis may turn and have one place only that is nearest to a point of its tube.
constexpr double k_single_cosine = 0.5;
constexpr int k_most_newton_steps = 60;
/// A step of Newton's method this short is the last one: what is left is its square.
constexpr double k_last_newton_step = 1e-7;

/// Around a cubic: the hull of its Bézier points.
Box3d box_of(const CubicStep<Vec3d>& c) {
  Box3d box;
  box.extend(c.a[0]), box.extend(c.a[0] + c.a[1] / 3.0), box.extend(c.a[0] + c.a[1] * (2.0 / 3) + c.a[2] / 3.0);
  box.extend(c.a[0] + c.a[1] + c.a[2] + c.a[3]);
  return box;
}

double distance(const Box3d& box, const Vec3d& p) { return glm::length(glm::max(glm::max(box.lower - p, p - box.upper), Vec3d(0))); }

double dot_of_abs(const Vec3d& a, const Vec3d& half) { return glm::dot(glm::abs(a), half); }

} // namespace

AxisWork& axis_work() {
  thread_local AxisWork mine;
  return mine;
}

struct AxisCurve::Index {
  std::vector<Vec3d> nodes;
  size_t kdtree_get_point_count() const { return nodes.size(); }
  double kdtree_get_pt(size_t i, size_t axis) const { return nodes[i][axis]; }
  template <class Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
  using Tree = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, Index>, Index, 3, size_t>;
  std::unique_ptr<Tree> tree;

  size_t nearest(const Vec3d& p, double& squared) const {
    size_t index = 0;
    tree->knnSearch(&p.x, 1, &index, &squared);
    return index;
  }
};

AxisCurve::AxisCurve(std::vector<CubicStep<Vec3d>> steps) : steps_(std::move(steps)) {
  auto index = std::make_shared<Index>();
  for (const CubicStep<Vec3d>& step : steps_) {
    const auto& a = step.a;
    squares_.push_back({glm::dot(a[1], a[1]), 3 * glm::dot(a[1], a[2]), 2 * glm::dot(a[2], a[2]) + 4 * glm::dot(a[1], a[3]),
                        5 * glm::dot(a[2], a[3]), 3 * glm::dot(a[3], a[3])});
    nodes_.push_back({step(0), step.first(0)});
    longest_step_ = std::max(longest_step_, box_of(step).diagonal());
  }
  nodes_.push_back({steps_.back()(1), steps_.back().first(1)});
  for (const Node& node : nodes_) index->nodes.push_back(node.at);
  index->tree = std::make_unique<Index::Tree>(3, *index);
  index->tree->buildIndex();
  index_ = std::move(index);
}

std::vector<double> AxisCurve::widest_tube() const {
  struct Sample {
    Vec3d at, tangent;
    double radius;
  };
  const size_t a_step = std::max<size_t>(2, (k_tube_samples + steps_.size() - 1) / steps_.size());
  const size_t count = steps_.size() * a_step + 1;
  std::vector<Sample> samples;
  for (size_t i = 0; i < count; ++i) {
    const size_t step = std::min(i / a_step, steps_.size() - 1);
    const double s = double(i - step * a_step) / double(a_step);
    const Vec3d first = steps_[step].first(s), second = steps_[step].second(s);
    const double speed = glm::length(first);
    const Vec3d tangent = speed > 0 ? first / speed : Vec3d(0);
    const double bend = glm::length(second - tangent * glm::dot(second, tangent));
    samples.push_back({steps_[step](s), tangent, speed > 0 ? (bend > 0 ? speed * speed / bend : INFINITY) : 0});
  }
  for (size_t i = 0; i < count; ++i) {
    Sample& here = samples[i];
    const double outward = i == 0 ? -1 : i + 1 == count ? 1 : 0; // at an end points beyond it count too
    for (const Sample& there : samples) {
      const Vec3d chord = there.at - here.at;
      const double squared = glm::dot(chord, chord), along = glm::dot(chord, here.tangent);
      const double across = outward * along > 0 ? std::sqrt(squared) : std::sqrt(std::max(0.0, squared - along * along));
      if (2 * across * here.radius > squared) here.radius = squared / (2 * across);
    }
  }
  std::vector<double> widest(steps_.size() + 1, INFINITY);
  for (size_t i = 0; i < count; ++i)
    for (size_t node = 0; node <= steps_.size(); ++node)
      if (i + a_step >= node * a_step && i <= (node + 1) * a_step) widest[node] = std::min(widest[node], samples[i].radius);
  return widest;
}

void AxisCurve::set_reach(std::vector<double> reach) {
  reach_ = std::move(reach);
  box_ = {}, most_reach_ = 0, boxes_.clear(), group_boxes_.clear(), spheres_.clear();
  for (size_t i = 0; i < steps_.size(); ++i) {
    const double most = std::max(reach_[i], reach_[i + 1]);
    const Box3d bare = box_of(steps_[i]);
    boxes_.push_back(bare.padded(most));
    spheres_.push_back({bare.centre(), 0.5 * bare.diagonal() + most});
    box_.extend(boxes_.back());
    if (i % k_group == 0) group_boxes_.emplace_back();
    group_boxes_.back().extend(boxes_.back());
    most_reach_ = std::max(most_reach_, most);
  }
  build_lattice();
}

void AxisCurve::build_lattice() {
  lattice_.origin = box_.lower;
  const Vec3d extent = glm::max(box_.extent(), Vec3d(1e-300));
  // Cells of a third of the radius, but not too many.
  double side = std::max(most_reach_ / 3, 1e-300);
  const double volume = extent.x * extent.y * extent.z / (side * side * side);
  if (volume > k_lattice_cells) side *= std::cbrt(volume / k_lattice_cells);
  size_t count = 1;
  for (int i = 0; i < 3; ++i) {
    lattice_.size[i] = std::clamp(static_cast<int>(std::ceil(extent[i] / side)), 1, 64);
    lattice_.cells_a_unit[i] = lattice_.size[i] / extent[i];
    count *= static_cast<size_t>(lattice_.size[i]);
  }
  const double half_diagonal = 0.5 * glm::length(1.0 / lattice_.cells_a_unit) * (1 + 1e-9);
  const double farthest = most_reach_ + longest_step_ + half_diagonal;
  lattice_.cells.assign(count, {});
  struct Steps {
    size_t first = SIZE_MAX, last = 0, count = 0;
  };
  std::vector<Steps> steps(count); // whose tubes come to a cell
  for (size_t step = 0; step < boxes_.size(); ++step) {
    const Box3d& b = boxes_[step];
    for (int z = lattice_.cell(b.lower, 2); z <= lattice_.cell(b.upper, 2); ++z)
      for (int y = lattice_.cell(b.lower, 1); y <= lattice_.cell(b.upper, 1); ++y)
        for (int x = lattice_.cell(b.lower, 0); x <= lattice_.cell(b.upper, 0); ++x) {
          Steps& here = steps[static_cast<size_t>((z * lattice_.size[1] + y) * lattice_.size[0] + x)];
          here.first = std::min(here.first, step), here.last = std::max(here.last, step), ++here.count;
        }
  }
  for (size_t i = 0; i < count; ++i) {
    if (steps[i].count == 0) continue;
    const size_t x = i % size_t(lattice_.size[0]), y = i / size_t(lattice_.size[0]) % size_t(lattice_.size[1]),
                 z = i / size_t(lattice_.size[0]) / size_t(lattice_.size[1]);
    const Vec3d centre = lattice_.origin + (Vec3d(double(x), double(y), double(z)) + 0.5) / lattice_.cells_a_unit;
    double squared = 0;
    const size_t node = index_->nearest(centre, squared);
    if (squared > farthest * farthest) continue;
    lattice_.cells[i].node = static_cast<uint16_t>(node);
    const Vec3d a = nodes_[steps[i].first].along, b = nodes_[steps[i].last + 1].along;
    lattice_.cells[i].is_single = steps[i].last - steps[i].first + 1 == steps[i].count &&
                                  glm::dot(a, b) > k_single_cosine * std::sqrt(glm::dot(a, a) * glm::dot(b, b));
  }
}

bool AxisCurve::find(const Vec3d& p, AxisFoot& foot) const {
  if (!box_.contains(p)) return false;
  const Lattice::Cell cell = lattice_.at(p);
  if (cell.node == Lattice::k_outside) return false;
  ++axis_work().inversions;
  if (find_from(cell.node, p, foot)) return true;
  if (cell.is_single) return false;
  double squared = 0;
  const size_t nearest = index_->nearest(p, squared);
  const double farthest = most_reach_ + longest_step_;
  if (squared > farthest * farthest || nearest == foot.step || nearest == foot.step + 1) return false;
  return find_from(nearest, p, foot);
}

bool AxisCurve::find_from(size_t node, const Vec3d& p, AxisFoot& foot) const {
  // The sign of (p - c) c' says on which side of a node the place is.
  const auto is_ahead = [&](size_t i) { return glm::dot(p - nodes_[i].at, nodes_[i].along) > 0; };
  const size_t last = steps_.size();
  double s = 0;
  if (is_ahead(node)) {
    while (node < last && is_ahead(node + 1)) ++node;
    foot.is_at_end = node == last;
    foot.step = node - foot.is_at_end, s = 1;
  } else {
    while (node > 0 && !is_ahead(node - 1)) --node;
    foot.is_at_end = node == 0;
    foot.step = node - !foot.is_at_end, s = 0;
  }
  const CubicStep<Vec3d>& c = steps_[foot.step];
  if (!foot.is_at_end) {
    // (p - c) c' as a polynomial of s, from the step's beginning; what depends on the step alone is known.
    const Vec3d q = p - c.a[0];
    const std::array<double, 5>& n = squares_[foot.step];
    const double f0 = glm::dot(q, c.a[1]), f1 = 2 * glm::dot(q, c.a[2]) - n[0], f2 = 3 * glm::dot(q, c.a[3]) - n[1];
    const auto f = [&](double t) { return f0 + t * (f1 + t * (f2 - t * (n[2] + t * (n[3] + t * n[4])))); };
    const auto g = [&](double t) { return -(f1 + t * (2 * f2 - t * (3 * n[2] + t * (4 * n[3] + t * (5 * n[4]))))); };
    const double at_high = f(1);
    double low = 0, high = 1;
    // Not so only by rounding, at a node.
    s = f0 > 0 && at_high < 0 ? f0 / (f0 - at_high) : f0 > 0 ? 1 : 0;
    AxisWork& work = axis_work();
    for (int i = 0; i < k_most_newton_steps; ++i) {
      ++work.newton_steps;
      const double here = f(s), slope = g(s);
      (here > 0 ? low : high) = s;
      double next = s + here / slope;
      const bool is_newton = slope > 0 && next >= low && next <= high;
      if (!is_newton) next = 0.5 * (low + high);
      const double change = std::abs(next - s);
      s = next;
      if (change < (is_newton ? k_last_newton_step : 1e-15)) break;
    }
  }
  const Vec3d offset = p - c(s), first = c.first(s);
  foot.s = s, foot.offset = offset, foot.first = first, foot.second = c.second(s);
  foot.distance = glm::length(offset), foot.reach = reach(foot.step, s);
  return foot.distance < foot.reach;
}

void AxisCurve::find(const Box3d& box, AxisRange& out) const {
  out.parts.clear(), out.is_inside = false;
  if (intersect(box, box_).is_empty()) return;
  if (!find_inside(box, out)) find_anywhere(box, out);
}

/// (p - c) c' over a box of points p.
Interval AxisCurve::slope_range(size_t step, double s, const Vec3d& centre, const Vec3d& half) const {
  const Vec3d first = steps_[step].first(s);
  const double middle = glm::dot(centre - steps_[step](s), first), width = dot_of_abs(first, half);
  return {middle - width, middle + width};
}

/// From the box's centre on the nearest place moves continuously while the point stays in the tube, and it does not pass a place
/// that is behind, or ahead, of all points of the box.
bool AxisCurve::find_inside(const Box3d& box, AxisRange& out) const {
  const Vec3d centre = box.centre(), half = box.extent() * 0.5;
  const double radius = glm::length(half);
  if (radius >= most_reach_) return false;
  AxisFoot& foot = out.centre;
  if (!find(centre, foot) || foot.distance + radius >= foot.reach) return false;
  const double first2 = glm::dot(foot.first, foot.first), g = first2 - glm::dot(foot.offset, foot.second);
  double reach_out = 1.1 * dot_of_abs(foot.first, half) / std::max(g, 0.05 * first2) + 1e-9;
  const auto last = static_cast<double>(steps_.size());
  const double at = static_cast<double>(foot.step) + foot.s;
  const auto place = [&](double along) {
    const size_t step = along <= 0 ? 0 : std::min(static_cast<size_t>(along), steps_.size() - 1);
    return std::pair{step, along - static_cast<double>(step)};
  };
  for (int tries = 0; tries < 5; ++tries, reach_out *= 2) {
    const double from = std::max(at - reach_out, 0.0), to = std::min(at + reach_out, last);
    const auto low = place(from), high = place(to);
    if (from > 0 && slope_range(low.first, low.second, centre, half).lo <= 0) continue;
    if (to < last && slope_range(high.first, high.second, centre, half).hi >= 0) continue;
    const bool start_counts = from == 0 && slope_range(0, 0, centre, half).lo <= 0;
    const bool end_counts = to == last && slope_range(steps_.size() - 1, 1, centre, half).hi >= 0;
    for (size_t step = low.first; step <= high.first; ++step) {
      AxisPart part{step, step == low.first ? low.second : 0, step == high.first ? high.second : 1};
      part.may_be_at_end = (step == 0 && start_counts) || (step + 1 == steps_.size() && end_counts);
      if (part.from == part.to && low.first != high.first) continue;
      if (foot.distance + radius >= std::min(reach(step, part.from), reach(step, part.to))) return out.parts.clear(), false;
      out.parts.push_back(part);
    }
    out.is_inside = true;
    return true;
  }
  return false;
}

/// Interval Newton: where in the step a nearest place may be. False: nowhere.
bool AxisCurve::contract(size_t step, const Box3d& box, AxisPart& part) const {
  const CubicStep<Vec3d>& c = steps_[step];
  const Vec3d centre = box.centre(), half = box.extent() * 0.5;
  part.may_be_at_end =
      (step == 0 && slope_range(0, 0, centre, half).lo <= 0) || (step + 1 == steps_.size() && slope_range(step, 1, centre, half).hi >= 0);
  const Vec3d third = glm::abs(6.0 * c.a[3]);
  for (int i = 0; i < 4; ++i) {
    const double m = 0.5 * (part.from + part.to), h = 0.5 * (part.to - part.from);
    const Vec3d offset = centre - c(m), first = c.first(m), second = c.second(m);
    const Vec3d offset_half = half + h * (glm::abs(first) + h * (0.5 * glm::abs(second) + (h / 6) * third));
    const Vec3d first_half = h * (glm::abs(second) + (0.5 * h) * third), second_half = h * third;
    Interval g(0.0);
    for (int k = 0; k < 3; ++k) {
      g = g + square(Interval{first[k] - first_half[k], first[k] + first_half[k]});
      g = g - Interval{offset[k] - offset_half[k], offset[k] + offset_half[k]} *
                  Interval{second[k] - second_half[k], second[k] + second_half[k]};
    }
    // In the tube 1 - curvature * distance is at least 0.1: whatever is steeper is outside.
    const double speed2 = std::max(0.0, glm::length(first) - glm::length(first_half));
    g.lo = std::max(g.lo, 0.05 * speed2 * speed2);
    if (!(g.lo > 0) || !(g.hi > 0)) break;
    const Interval f = slope_range(step, m, centre, half) / g;
    const double low = std::max(part.from, m + f.lo), high = std::min(part.to, m + f.hi);
    if (low > high) {
      if (!part.may_be_at_end) return false;
      part.from = part.to = step == 0 && slope_range(0, 0, centre, half).lo <= 0 ? 0 : 1;
      if (steps_.size() == 1) part.from = 0, part.to = 1;
      return true;
    }
    const bool is_slow = high - low > 0.7 * (part.to - part.from);
    part.from = low, part.to = high;
    if (part.may_be_at_end) { // an end stays in
      if (step == 0 && slope_range(0, 0, centre, half).lo <= 0) part.from = 0;
      if (step + 1 == steps_.size() && slope_range(step, 1, centre, half).hi >= 0) part.to = 1;
    }
    if (is_slow) break;
  }
  return true;
}

void AxisCurve::find_anywhere(const Box3d& box, AxisRange& out) const {
  for (size_t step = 0; step < steps_.size(); ++step) {
    if (step % k_group == 0 && intersect(box, group_boxes_[step / k_group]).is_empty()) {
      step += k_group - 1;
      continue;
    }
    if (distance(box, spheres_[step].centre) > spheres_[step].radius) continue;
    AxisPart part{step};
    if (contract(step, box, part)) out.parts.push_back(part);
  }
}

} // namespace kelpie
