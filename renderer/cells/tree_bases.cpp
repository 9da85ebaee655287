#include "renderer/cells/tree_bases.h"

#include <cmath>
#include <limits>

#include "renderer/program/evaluate.h"

namespace kelpie {

double lipschitz(const Mat3d& m) {
  const Mat3d g = glm::transpose(m) * m;
  const double trace = g[0][0] + g[1][1] + g[2][2];
  double off = 0;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) off = std::max(off, std::abs(g[i][j] - (i == j ? trace / 3 : 0)));
  return std::sqrt(off < 1e-9 * trace ? trace / 3 : trace);
}

double turning(const FieldProgram& program, uint32_t space, const Box3& box) {
  using Variable = Dual<Interval, 3>;
  const auto variable = [&](int i) { return Variable::variable({box.lower[i], box.upper[i]}, i); };
  SpacePoints<Variable> points;
  points.begin(program);
  const Point3<Variable> p = points.at(program, space, {variable(0), variable(1), variable(2)});
  double sum = 0;
  for (const Variable& x : {p.x, p.y, p.z})
    for (const Interval& d : x.d) sum += square(d.width());
  return std::isnan(sum) ? std::numeric_limits<double>::infinity() : std::sqrt(sum);
}

namespace {

/// g++ 12 makes nothing of Vec3d(Vec3(v)): it folds the conversions of two lanes at once, and drops the rounding.
Vec3d rounded_to_float(const Vec3d& v) {
  Vec3d r;
  for (int i = 0; i < 3; ++i) {
    const volatile float rounded = static_cast<float>(v[i]);
    r[i] = rounded;
  }
  return r;
}

} // namespace

bool TreeBases::find(uint32_t space_index, TreeBase& base, Affine& local_from_base) {
  const Space& space = program_.spaces[space_index];
  const bool is_warp = space.warp != Space::k_no_warp;
  local_from_base = is_warp ? Affine{} : space.local_from_parent;
  const uint32_t warped = is_warp ? space_index : space.parent;
  base.centre = Vec3d(centre_);
  if (warped == 0) return true;
  for (const auto& [index, known] : known_)
    if (index == warped) {
      base = known;
      return true;
    }
  const Space& warp = program_.spaces[warped];
  TreeBase parent;
  Affine parent_from_base;
  if (!find(warp.parent, parent, parent_from_base)) return false;
  base.slot = static_cast<uint32_t>(out_.spaces.size()) + 1;
  SpacePoints<double> points;
  points.begin(program_);
  const Point3<double> c = points.at(program_, warped, {base.centre.x, base.centre.y, base.centre.z});
  base.centre = rounded_to_float({c.x, c.y, c.z});
  base.turning = turning(program_, warped, cell_);
  if (!(base.turning <= k_most_drift) || out_.spaces.size() == k_tree_spaces) return false;
  const Affine warp_from_base = warp.local_from_parent * parent_from_base;
  find_bending(warp, parent, lipschitz(warp_from_base.linear), base);
  const LaneWarp lanes = std::visit(
      [&](const auto& kind) {
        if constexpr (std::is_same_v<decltype(kind), const Axial<SampledMode>&>)
          return lane_warp(kind, warp_from_base, parent.centre, base.centre, box_before(warp), out_.axes);
        else
          return lane_warp(kind, warp_from_base, parent.centre, base.centre);
      },
      program_.field.nodes[warp.warp]);
  out_.spaces.push_back({warped, Vec3(base.centre), parent.slot, lanes});
  known_.emplace_back(warped, base);
  return true;
}

/// By the chain rule: second derivatives of the warp times first derivatives before it, squared, and the other way round.
void TreeBases::find_bending(const Space& warp, const TreeBase& parent, double lipschitz_between, TreeBase& base) const {
  const Box3d box = box_before(warp);
  const Point3<Interval> p{{box.lower.x, box.upper.x}, {box.lower.y, box.upper.y}, {box.lower.z, box.upper.z}};
  std::visit(
      [&](const auto& kind) {
        base.bending = std::numeric_limits<double>::infinity();
        if constexpr (requires { kind.most_bending(p); }) {
          using Variable = Dual<Interval, 3>;
          const Point3<Variable> image =
              kind.child_from_parent(Point3<Variable>{Variable::variable(p.x, 0), Variable::variable(p.y, 1), Variable::variable(p.z, 2)});
          double sum = 0;
          for (const Variable& x : {image.x, image.y, image.z})
            for (const Interval& d : x.d) sum += square(d.magnitude());
          const double of_warp = std::sqrt(sum), before = lipschitz_between * parent.lipschitz;
          base.lipschitz = of_warp * before;
          base.bending = kind.most_bending(p) * square(before);
          if (parent.bending > 0) base.bending += of_warp * lipschitz_between * parent.bending;
          if (std::isnan(base.bending)) base.bending = std::numeric_limits<double>::infinity();
        }
      },
      program_.field.nodes[warp.warp]);
}

/// Around where the cell is before it is warped.
Box3d TreeBases::box_before(const Space& warp) const {
  SpacePoints<Interval> points;
  points.begin(program_);
  const auto range = [&](int i) { return Interval{cell_.lower[i], cell_.upper[i]}; };
  const Point3<Interval> p = warp.local_from_parent.apply(points.at(program_, warp.parent, {range(0), range(1), range(2)}));
  return {{p.x.lo, p.y.lo, p.z.lo}, {p.x.hi, p.y.hi, p.z.hi}};
}

} // namespace kelpie
