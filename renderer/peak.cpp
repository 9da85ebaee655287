#include "renderer/peak.h"

#include <cmath>
#include <limits>
#include <queue>

#include "renderer/program/bound.h"

namespace kelpie {

namespace {

/// How near to a field's largest value its bound comes.
constexpr double k_peak_gap = 1e-4;
/// Costs in units of work, of one blob and of any other step.
constexpr int64_t k_blob_work = 1, k_step_work = 100;

int64_t work_of(const Code& code) {
  return static_cast<int64_t>(code.blobs.size()) * k_blob_work + static_cast<int64_t>(code.steps.size()) * k_step_work;
}

/// The largest value of a field, by boxes of which the one that promises most is halved.
class PeakSearch {
public:
  /// With `only_sign` on which side of the threshold the field is stays true, not its values.
  PeakSearch(const FieldProgram& program, bool only_sign, int64_t& work) : program_(program), only_sign_(only_sign), work_(work) {
    if (!program.support.is_empty()) push(program.support, program.code, 0);
  }

  /// What the field is at most; 0 if it is nowhere above, as it is outside its support.
  double at_most() const { return boxes_.empty() ? 0 : boxes_.top().most; }
  /// What it is somewhere.
  double at_least() const { return at_least_; }
  bool has_work() const { return work_ > 0; }

  void step() {
    const Box top = boxes_.top();
    boxes_.pop();
    const Vec3d c = top.box.centre(), extent = top.box.extent();
    at_least_ = std::max(at_least_, evaluate(program_, top.code, Point3<double>{c.x, c.y, c.z}));
    const int axis = extent.x >= std::max(extent.y, extent.z) ? 0 : extent.y >= extent.z ? 1 : 2;
    Box3d below = top.box, above = top.box;
    below.upper[axis] = above.lower[axis] = c[axis];
    push(below, top.code, top.depth + 1), push(above, top.code, top.depth + 1);
  }

private:
  struct Box {
    double most;
    int depth;
    Box3d box;
    Code code;
    /// Of equals, as there are many along a skeleton, the smallest comes first.
    bool operator<(const Box& other) const { return most != other.most ? most < other.most : depth < other.depth; }
  };

  void push(const Box3d& box, const Code& parent, int depth) {
    work_ -= work_of(parent);
    std::vector<Interval> ranges;
    Code code = bound(program_, parent, box, ranges);
    const double most = ranges.back().hi;
    if (only_sign_) code = prune(program_, code, ranges);
    if (most > 0) boxes_.push({most, depth, box, std::move(code)});
  }

  const FieldProgram& program_;
  const bool only_sign_;
  int64_t& work_;
  double at_least_ = 0;
  std::priority_queue<Box> boxes_;
};

} // namespace

Surface find_surface(const FieldProgram& program, int64_t& work) {
  const double least = program.threshold * (1 + k_peak_margin);
  PeakSearch search(program, true, work);
  while (search.at_most() > least) {
    if (!search.has_work()) return Surface::unknown;
    search.step();
    if (search.at_least() > least) return Surface::present;
  }
  return Surface::none;
}

double peak_of(const FieldProgram& program, int64_t& work) {
  PeakSearch search(program, false, work);
  while (search.has_work() && search.at_most() > search.at_least() * (1 + k_peak_gap)) search.step();
  return search.at_most();
}

namespace {

/// visit(kind) for the skeleton of a step.
template <class Visit>
void visit_skeleton(const FieldProgram& program, const Instruction& step, Visit&& visit) {
  std::visit(
      [&]<class K>(const K& kind) {
        if constexpr (Skeleton<K>) visit(kind);
      },
      program.field.nodes[step.node]);
}

/// The point of a solid that is nearest to `p`: the gradient of the squared distance is twice the way from it.
template <SolidSkeleton Kind>
Vec3d nearest(const Kind& kind, const Vec3d& p) {
  using D = Dual<double, 3>;
  const D d2 = squared_distance(kind.solid(), Point3<D>{D::variable(p.x, 0), D::variable(p.y, 1), D::variable(p.z, 2)});
  return p - 0.5 * Vec3d(d2.d[0], d2.d[1], d2.d[2]);
}

/// Whether on a quarter or more of the skeleton the field is the threshold and no more.
template <SolidSkeleton Kind>
bool is_bare(const FieldProgram& program, const Kind& kind, const Affine& world_from_local) {
  constexpr int k_side = 4;
  const Box3 box = kind.support();
  int bare = 0;
  for (int i = 0; i < k_side * k_side * k_side; ++i) {
    const Vec3d place = (Vec3d(i % k_side, i / k_side % k_side, i / k_side / k_side) + 0.5) / double(k_side);
    const Vec3d p = world_from_local(nearest(kind, glm::mix(Vec3d(box.lower), Vec3d(box.upper), place)));
    const double f = evaluate(program, program.code, Point3<double>{p.x, p.y, p.z});
    bare += std::abs(f - program.threshold) <= k_peak_margin * program.threshold;
  }
  return 4 * bare >= k_side * k_side * k_side;
}

/// The complex primitive that a node is a piece of; itself where it is none.
size_t whole(const SampledField& field, size_t node) {
  for (size_t i = 0; i <= field.root() && node > field.root(); ++i)
    std::visit(
        [&]<class K>(const K& kind) {
          if constexpr (ComplexPrimitive<K>)
            if (node - kind.expansion.first < kind.expansion.count) node = i;
        },
        field.nodes[i]);
  return node;
}

} // namespace

double peak_of_weakest_leaf(const FieldProgram& program) {
  double least = std::numeric_limits<double>::infinity();
  const auto add = [&](double peak) {
    if (peak > 0) least = std::min(least, peak);
  };
  for (size_t i = 0; i < program.blobs.size(); ++i) add(double(program.blobs.a[i]) + double(program.blobs.b[i]));
  for (const Instruction& step : program.code.steps)
    if (step.kind == Instruction::Kind::skeleton)
      visit_skeleton(program, step, [&]<class K>(const K& kind) {
        double most = double(kind.weight) * potential_unit(kind, program.threshold);
        if constexpr (SignedDistance<K>)
          if (kind.is_in_thresholds()) most *= 2; // deep inside
        add(most);
      });
  return least;
}

std::optional<size_t> skeleton_at_threshold(const FieldProgram& program) {
  constexpr size_t k_most_skeletons = 16, k_most_steps = 20000; // together they bound the work
  const std::vector<Instruction>& steps = program.code.steps;
  size_t left = std::min(k_most_skeletons, k_most_steps / steps.size());
  std::optional<size_t> found;
  for (const Instruction& step : steps) {
    if (left == 0 || found) break;
    if (step.kind != Instruction::Kind::skeleton || !program.spaces[step.space].is_affine_in_world()) continue;
    visit_skeleton(program, step, [&]<class K>(const K& kind) {
      if constexpr (SolidSkeleton<K>) {
        if (std::abs(double(kind.weight) - program.threshold) > k_peak_margin * program.threshold) return;
        --left;
        if (is_bare(program, kind, inverse(program.spaces[step.space].local_from_parent))) found = whole(program.field, step.node);
      }
    });
  }
  return found;
}

} // namespace kelpie
