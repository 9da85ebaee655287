#include "renderer/mesh/octree.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>

#include <fmt/format.h>

#include "base/error.h"
#include "base/memory_limit.h"
#include "base/parallel.h"

namespace kelpie {

namespace {

/// What all stages of meshing take for each leaf, about, bytes: of the peak of the process 7,400 for a chair, 18,000 for a box.
constexpr size_t k_bytes_per_leaf = 20'000;
/// Cells are never larger than this part of the root: samples must see the surface.
constexpr uint32_t k_coarsest = 16;
/// Where no proof is found, as at the kinks of signed distances, cells of this part of the root are taken to have one sheet if their
/// samples do.
constexpr uint32_t k_trusted = 128;
/// The same of cells no larger than so many tolerances.
constexpr double k_seen = 4;
/// What shows no surface is divided this many times further than what does.
constexpr uint32_t k_extra_levels = 1;
/// Normals at the ends of a cell part from a plane by this many times as much as the triangles in it, which are much smaller.
constexpr double k_flatness = 4;

size_t size_of(const Code& code) { return code.steps.size() + code.operands.size() + code.blobs.size(); }

/// What samples of a cell show of the surface in it.
struct Look {
  bool is_crossed = false;
  bool is_flat = false;
};

class Samples {
public:
  Samples(const Solid& solid, const Code& code, const Box3d& box) : solid_(solid), code_(code), box_(box) {
    for (size_t i = 0; i < values_.size(); ++i) values_[i] = solid.value(code, at(i));
  }

  Look look(double tolerance) {
    Look out;
    const auto inside = std::count_if(values_.begin(), values_.end(), [](double v) { return v > 0; });
    out.is_crossed = inside > 0 && inside < 27;
    if (!out.is_crossed) return out;
    for (size_t i = 0; i < 27; ++i) {
      if (i % 3 < 2) add_crossing(i, i + 1);
      if (i / 3 % 3 < 2) add_crossing(i, i + 3);
      if (i / 9 < 2) add_crossing(i, i + 9);
    }
    out.is_flat = places_.size() >= 2 && is_flat(tolerance);
    return out;
  }

private:
  Vec3d at(size_t i) const { return box_.lower + box_.extent() * 0.5 * Vec3d(double(i % 3), double(i / 3 % 3), double(i / 9)); }

  /// Where the surface crosses the way between two samples, about, moved onto it along the gradient.
  void add_crossing(size_t a, size_t b) {
    if ((values_[a] > 0) == (values_[b] > 0)) return;
    if (values_[a] <= 0) std::swap(a, b);
    constexpr double k_nudge = 1e-4; // outward: a field may have a kink exactly at its surface, and no slope there
    const double part = std::min(1.0, values_[a] / (values_[a] - values_[b]) + k_nudge);
    const Vec3d p = at(a) + part * (at(b) - at(a));
    const Vec3d slope = solid_.gradient(code_, p);
    const double steepness = glm::length(slope);
    if (!(steepness > 0)) return;
    const double off = std::clamp(solid_.value(code_, p) / steepness, -box_.extent().x, box_.extent().x);
    places_.push_back(p - off * slope / steepness), normals_.push_back(-slope / steepness);
  }

  bool is_flat(double tolerance) const {
    for (size_t a = 0; a < places_.size(); ++a)
      for (size_t b = 0; b < places_.size(); ++b)
        if (std::abs(glm::dot(normals_[a], places_[b] - places_[a])) > tolerance) return false;
    return true;
  }

  const Solid& solid_;
  const Code& code_;
  Box3d box_;
  std::array<double, 27> values_;
  std::vector<Vec3d> places_, normals_;
};

} // namespace

/// What becomes of a cell.
struct Octree::Decision {
  bool is_proved = false, is_crossed = false, is_divided = false;
  std::optional<Code> code; ///< its own; none: that of its parent will do
};

Octree::Octree(const Solid& solid, double tolerance) : solid_(solid), tolerance_(tolerance) {
  const Box3d bounds = solid.bounds();
  const Vec3d extent = bounds.extent();
  const double side = 1.02 * std::max({extent.x, extent.y, extent.z});
  const double levels = std::ceil(std::log2(std::max(side / (1.0 * tolerance), double(k_coarsest)))) + k_extra_levels;
  root_side_ = 2u << static_cast<uint32_t>(levels);
  tick_ = side / root_side_;
  origin_ = bounds.centre() - Vec3d(side / 2);
  cells_.emplace_back();
  codes_.push_back(solid.code());
  const Leaf root{0, {0, 0, 0}, root_side_};
  divide({root});
  make_whole();
  find_leaves(root);
}

Box3d Octree::box_of(const Leaf& leaf) const {
  const uint32_t s = leaf.side;
  return {position(leaf.lower), position({leaf.lower[0] + s, leaf.lower[1] + s, leaf.lower[2] + s})};
}

Octree::Decision Octree::decide(const Leaf& leaf) const {
  const Code& parent = codes_[cells_[leaf.cell].code];
  const Box3d box = box_of(leaf);
  Decision out;
  Solid::InBox in_box = solid_.in_box(box, parent);
  out.is_proved = in_box.content != Solid::Content::unknown;
  if (out.is_proved) return out;
  const bool is_smallest = leaf.side == 2, is_small = leaf.side <= (2u << k_extra_levels);
  if (leaf.side * k_coarsest > root_side_)
    out.is_divided = true;
  else if (!is_small && leaf.side * k_trusted > root_side_ && leaf.side * tick_ > k_seen * tolerance_ &&
           !solid_.is_one_sheet(in_box.code, box))
    out.is_divided = true;
  else {
    const Look look = Samples(solid_, in_box.code, box).look(k_flatness * tolerance_);
    out.is_crossed = look.is_crossed;
    out.is_divided = !is_smallest && (!look.is_crossed || !(look.is_flat || is_small));
  }
  if (size_of(in_box.code) * 4 <= size_of(parent) * 3) out.code = std::move(in_box.code);
  return out;
}

void Octree::divide(std::vector<Leaf> frontier) {
  const size_t most_leaves = usable_memory() / k_bytes_per_leaf;
  size_t unproved = 0;
  while (!frontier.empty()) {
    std::vector<Decision> decisions(frontier.size());
    parallel_for(size_t(0), frontier.size(), [&](size_t i) { decisions[i] = decide(frontier[i]); });
    std::vector<Leaf> next;
    for (size_t i = 0; i < frontier.size(); ++i) {
      const Leaf& leaf = frontier[i];
      Decision& decision = decisions[i];
      cells_[leaf.cell].is_proved = decision.is_proved, cells_[leaf.cell].is_crossed = decision.is_crossed;
      if (decision.code) cells_[leaf.cell].code = static_cast<uint32_t>(codes_.size()), codes_.push_back(std::move(*decision.code));
      unproved += !decision.is_divided && !decision.is_proved;
      if (!decision.is_divided) continue;
      const auto first = static_cast<uint32_t>(cells_.size());
      cells_[leaf.cell].first_child = first;
      cells_.resize(cells_.size() + 8, {0, cells_[leaf.cell].code});
      for (uint32_t child = 0; child < 8; ++child) next.push_back(child_of(leaf, child));
    }
    if (unproved + next.size() / 4 > most_leaves)
      throw Error(ExitStatus::out_of_memory,
                  fmt::format("a mesh as fine as this takes more than {} MB: a coarser --tolerance takes less", usable_memory() >> 20));
    frontier = std::move(next);
  }
}

/// Undoes divisions that found no surface: small cells would divide the tetrahedra of their neighbours for nothing.
void Octree::make_whole() {
  for (size_t i = cells_.size(); i-- > 0;) { // children before parents
    Cell& cell = cells_[i];
    if (cell.first_child == 0) continue;
    const std::span children(&cells_[cell.first_child], 8);
    if (std::any_of(children.begin(), children.end(), [](const Cell& c) { return c.first_child != 0 || c.is_crossed; })) continue;
    cell.is_proved = std::all_of(children.begin(), children.end(), [](const Cell& c) { return c.is_proved; });
    cell.first_child = 0;
  }
}

void Octree::find_leaves(const Leaf& within) {
  const Cell& cell = cells_[within.cell];
  if (cell.first_child == 0) {
    if (!cell.is_proved) leaves_.push_back(within);
    return;
  }
  for (uint32_t child = 0; child < 8; ++child) find_leaves(child_of(within, child));
}

Octree::Leaf Octree::child_of(const Leaf& parent, uint32_t child) const {
  const uint32_t half = parent.side / 2;
  const auto& [x, y, z] = parent.lower;
  return {cells_[parent.cell].first_child + child, {x + (child & 1) * half, y + (child >> 1 & 1) * half, z + (child >> 2) * half}, half};
}

const Octree::Cell& Octree::find(const Place& place, uint32_t side, uint32_t& found_side) const {
  const Cell* cell = &cells_[0];
  found_side = root_side_;
  while (cell->first_child && found_side > side) {
    found_side /= 2;
    const uint32_t child = ((place[0] & found_side) != 0) + 2 * ((place[1] & found_side) != 0) + 4 * ((place[2] & found_side) != 0);
    cell = &cells_[cell->first_child + child];
  }
  return *cell;
}

bool Octree::is_divided(const Place& place, uint32_t side) const {
  if (place[0] >= root_side_ || place[1] >= root_side_ || place[2] >= root_side_) return false; // below 0 it is large
  uint32_t found_side = 0;
  return find(place, side, found_side).first_child != 0 && found_side == side;
}

const Code& Octree::code_at(const Place& place) const {
  const Place within{std::min(place[0], root_side_ - 1), std::min(place[1], root_side_ - 1), std::min(place[2], root_side_ - 1)};
  uint32_t side = 0;
  return codes_[find(within, 0, side).code];
}

} // namespace kelpie
