#include "renderer/program/motion.h"

#include <algorithm>
#include <array>
#include <limits>

#include "field/motion.h"
#include "renderer/program/support.h"

namespace kelpie {

namespace {

using Node = FieldKinds::Variant<SampledMode>;

/// Calls visit(kind of a, kind of b): two nodes of one place in the tree.
template <class Visit>
auto visit_both(const Node& a, const Node& b, Visit&& visit) {
  return std::visit([&](const auto& kind) { return visit(kind, std::get<std::decay_t<decltype(kind)>>(b)); }, a);
}

void interpolate(const Node& a, const Node& b, double u, Node& out) {
  std::visit(
      [&](auto& kind) {
        using K = std::decay_t<decltype(kind)>;
        interpolate(std::get<K>(a), std::get<K>(b), u, kind);
      },
      out);
}

bool is_same(const Node& a, const Node& b) {
  return visit_both(a, b, [](const auto& p, const auto& q) { return is_same(p, q); });
}

bool is_same(const Space& a, const Space& b) {
  return a.local_from_parent.linear == b.local_from_parent.linear && a.local_from_parent.offset == b.local_from_parent.offset;
}

bool is_same(const BlobArrays& a, const BlobArrays& b) {
  return a.x == b.x && a.y == b.y && a.z == b.z && a.k == b.k && a.a == b.a && a.b == b.b && a.shapes == b.shapes;
}

/// What cannot say how far it moves stands as it is in the middle.
void hold_unbounded(FieldProgram& start, FieldProgram& end, const SampledField& middle) {
  for (size_t i = 0; i < start.field.nodes.size(); ++i)
    std::visit(
        [&]<class K>(const K&) {
          if constexpr (Warp<K> && !MovingWarp<K>) start.field.nodes[i] = end.field.nodes[i] = middle.nodes[i];
        },
        middle.nodes[i]);
}

} // namespace

bool set_in_motion(FieldProgram& start, FieldProgram end, const SampledField* held) {
  if (held) {
    hold_unbounded(start, end, *held);
    find_support(start, nullptr, start.support); // what is held may reach elsewhere
  }
  auto motion = std::make_shared<Motion>();
  bool moves = start.threshold != end.threshold || !is_same(start.blobs, end.blobs);
  for (size_t i = 0; i < start.field.nodes.size(); ++i) {
    const Node &a = start.field.nodes[i], &b = end.field.nodes[i];
    motion->nodes.push_back(!is_same(a, b));
    motion->middle.nodes.push_back(a);
    interpolate(a, b, 0.5, motion->middle.nodes.back());
  }
  for (size_t i = 0; i < start.spaces.size(); ++i) {
    const Space& space = start.spaces[i];
    const bool by_itself = !is_same(space, end.spaces[i]) || (space.warp != Space::k_no_warp && motion->nodes[space.warp]);
    motion->spaces.push_back(by_itself || (i > 0 && motion->spaces[space.parent]));
  }
  for (const Instruction& step : start.code.steps)
    moves = moves || motion->spaces[step.space] || (step.kind != Instruction::Kind::blobs && motion->nodes[step.node]);
  if (!moves) return true;
  const BlobArrays &s = start.blobs, &e = end.blobs;
  motion->blobs_change = s.k != e.k || s.a != e.a || s.b != e.b || s.radius != e.radius || s.shapes != e.shapes;
  motion->end = std::move(end);
  if (!find_support(start, motion.get(), start.support)) return false;
  for (uint32_t i = 0; i < motion->nodes.size(); ++i)
    if (motion->nodes[i]) start.hulls.erase(i); // faces are those of one moment
  start.motion = std::move(motion);
  return true;
}

namespace {

/// Puts a space, and those that it lies in, where they are at a time.
void move_space(const FieldProgram& program, uint32_t index, double u, FieldProgram& now) {
  const Motion& motion = *program.motion;
  for (uint32_t i = index; motion.spaces[i]; i = program.spaces[i].parent) {
    const Space& space = program.spaces[i];
    now.spaces[i].local_from_parent = interpolate(space.local_from_parent, motion.end.spaces[i].local_from_parent, u);
    if (space.warp != Space::k_no_warp && motion.nodes[space.warp])
      interpolate(program.field.nodes[space.warp], motion.end.field.nodes[space.warp], u, now.field.nodes[space.warp]);
  }
}

} // namespace

const FieldProgram& at(const FieldProgram& program, const CodeView& code, double u) {
  if (!program.motion) return program;
  const Motion& motion = *program.motion;
  FieldProgram& now = motion.now.local();
  if (now.spaces.empty()) {
    now.field = program.field, now.spaces = program.spaces, now.hulls = program.hulls;
    now.support = program.support, now.identities = program.identities;
  }
  now.threshold = threshold_at(program, u);
  now.moving_blobs = {&program.blobs, &motion.end.blobs, static_cast<float>(u)};
  uint32_t moved = 0; // steps of one space are neighbours, mostly
  for (const Instruction& step : code.steps) {
    if (step.kind != Instruction::Kind::blobs && motion.nodes[step.node])
      interpolate(program.field.nodes[step.node], motion.end.field.nodes[step.node], u, now.field.nodes[step.node]);
    if (step.space != moved) move_space(program, step.space, u, now);
    moved = step.space;
  }
  return now;
}

const FieldProgram& at_with_materials(const FieldProgram& program, const CodeView& code, double u) {
  if (!program.motion) return program;
  const FieldProgram& seen = at(program, code, u);
  FieldProgram& now = program.motion->now.local();
  const Identities& whose = *program.identities;
  uint32_t moved = 0;
  const auto move_place = [&](uint32_t place) {
    const uint32_t space = whose.places[place].space;
    if (space != moved) move_space(program, space, u, now);
    moved = space;
  };
  for (const Instruction& step : code.steps) {
    if (step.kind == Instruction::Kind::skeleton) move_place(step.first);
    if (step.kind == Instruction::Kind::blobs)
      for (const uint32_t i : code.blobs.subspan(step.first, step.count)) move_place(whose.blobs[i].place);
  }
  return seen;
}

Box3d image_in_space(const FieldProgram& program, uint32_t index, const Box3d& world) {
  if (index == 0) return world;
  const Motion& motion = *program.motion;
  const Space &a = program.spaces[index], &b = motion.end.spaces[index];
  const Box3d parent = image_in_space(program, a.parent, world);
  // For a point that stays the interpolated image runs along a straight line.
  Box3d box = image_of(a.local_from_parent, parent);
  box.extend(image_of(b.local_from_parent, parent));
  if (a.warp == Space::k_no_warp) return box;
  return std::visit(
      [&](const auto& middle) -> Box3d {
        using K = std::decay_t<decltype(middle)>;
        if constexpr (Warp<K>) {
          const Point3<Interval> q = middle.child_from_parent(
              Point3<Interval>{{box.lower.x, box.upper.x}, {box.lower.y, box.upper.y}, {box.lower.z, box.upper.z}});
          return grown({{q.x.lo, q.y.lo, q.z.lo}, {q.x.hi, q.y.hi, q.z.hi}},
                       displacement(middle, std::get<K>(program.field.nodes[a.warp]), std::get<K>(motion.end.field.nodes[a.warp]), box,
                                    WarpWay::to_child));
        }
        return box;
      },
      motion.middle.nodes[a.warp]);
}

// --- how much moves ---

namespace {

class Comparison {
public:
  Comparison(const FieldProgram& a, const FieldProgram& b) : a_(a), b_(b) {}

  ProgramDifference run() {
    rest(a_.threshold, b_.threshold);
    for (const Instruction& step : b_.code.steps) { // that of a_ is the same, if it has any
      if (step.kind == Instruction::Kind::blobs)
        compare_blobs(step);
      else
        visit_both(a_.field.nodes[step.node], b_.field.nodes[step.node], [&](const auto& p, const auto& q) { compare(step, p, q); });
    }
    if (places_.empty()) return {0, most_};
    const auto farthest = std::max_element(places_.begin(), places_.end());
    most_ = std::max(most_, *farthest);
    const auto nth = places_.begin() + std::ptrdiff_t(places_.size() * 98 / 100);
    std::nth_element(places_.begin(), nth, places_.end());
    return {*nth, most_};
  }

private:
  void rest(double x, double y) {
    if (x != y) most_ = std::max(most_, std::abs(x - y) / std::max(std::abs(x), std::abs(y)));
  }

  void rest(const Vec3& x, const Vec3& y) {
    for (int i = 0; i < 3; ++i) rest(x[i], y[i]);
  }

  void compare_blobs(const Instruction& step) {
    Box3d box;
    double least = std::numeric_limits<double>::infinity();
    for (uint32_t j = 0; j < step.count; ++j) {
      const uint32_t i = b_.code.blobs[step.first + j];
      const BlobNumbers s = a_.blob(i), e = b_.blob(i);
      const Vec3d p(s.x, s.y, s.z), q(e.x, e.y, e.z);
      // 1 / sqrt(k) and not the radius, which interpolated programs do not have.
      const double radius = 1 / std::sqrt(double(std::max(s.k, e.k)));
      if (b_.has_round_blobs()) {
        places_.push_back(glm::distance(p, q) / radius);
        rest(s.k, e.k);
      } else { // in the unit ball; what turns or stretches moves the ends of the longest half axis most
        places_.push_back(glm::length(s.shape(p - q)));
        const Mat3d change = s.shape.matrix() - e.shape.matrix();
        places_.push_back(std::sqrt(glm::dot(change[0], change[0]) + glm::dot(change[1], change[1]) + glm::dot(change[2], change[2])) *
                          radius);
      }
      most_ = std::max(most_, (std::abs(s.a - e.a) + std::abs(s.b - e.b)) / a_.threshold);
      box.extend(p), least = std::min(least, radius);
    }
    if (step.count > 0) compare_spaces(step.space, box.padded(least), least);
  }

  template <class Kind>
  void compare(const Instruction& step, const Kind& p, const Kind& q) {
    if constexpr (Skeleton<Kind>) {
      const double radius = std::min(reach_of(p), reach_of(q));
      const Box3 support = p.support();
      Box3d box{Vec3d(support.lower), Vec3d(support.upper)};
      if constexpr (requires { Kind::k_is_unbounded; }) box = seen_from(step.space);
      places_.push_back(displacement(p, q, box) / radius);
      rest(reach_of(p), reach_of(q)), rest(p.weight, q.weight);
      compare_spaces(step.space, box, radius);
    } else {
      for_each_number([&](const auto& x, const auto& y) { rest(x, y); }, p, q);
    }
  }

  /// Where the same points of the world are in a space: the corners of a box and its centre.
  void compare_spaces(uint32_t space, const Box3d& box, double radius) {
    if (space == 0) return;
    for (const Vec3d& p : places_in(box)) {
      const Vec3d world = in_world(a_, space, p);
      places_.push_back(glm::distance(in_space(a_, space, world), in_space(b_, space, world)) / radius);
    }
  }

  static std::array<Vec3d, 9> places_in(const Box3d& box) {
    std::array<Vec3d, 9> places;
    places.fill(box.centre());
    for (int corner = 0; corner < 8; ++corner)
      for (int i = 0; i < 3; ++i) places[size_t(corner)][i] = corner >> i & 1 ? box.upper[i] : box.lower[i];
    return places;
  }

  /// About where the whole field is, in a space.
  Box3d seen_from(uint32_t space) const {
    Box3d box;
    for (const Vec3d& p : places_in(a_.support)) box.extend(in_space(a_, space, p));
    return box;
  }

  static Vec3d in_world(const FieldProgram& program, uint32_t space, Vec3d p) {
    for (uint32_t i = space; i != 0; i = program.spaces[i].parent) {
      if (program.spaces[i].warp != Space::k_no_warp)
        std::visit(
            [&](const auto& kind) {
              if constexpr (Warp<std::decay_t<decltype(kind)>>) {
                const Point3<double> q = kind.parent_from_child(Point3<double>{p.x, p.y, p.z});
                p = {q.x, q.y, q.z};
              }
            },
            program.field.nodes[program.spaces[i].warp]);
      p = inverse(program.spaces[i].local_from_parent)(p);
    }
    return p;
  }

  static Vec3d in_space(const FieldProgram& program, uint32_t space, const Vec3d& world) {
    SpacePoints<double> points;
    points.begin(program);
    const Point3<double> p = points.at(program, space, {world.x, world.y, world.z});
    return {p.x, p.y, p.z};
  }

  const FieldProgram &a_, &b_;
  std::vector<double> places_;
  double most_ = 0;
};

} // namespace

ProgramDifference difference(const FieldProgram& a, const FieldProgram& b) { return Comparison(a, b).run(); }

// --- memory ---

size_t program_bytes(const FieldProgram& p) {
  const size_t lists = p.blobs.are_round() ? 7 : 8 + BlobShapes::k_members.size();
  size_t bytes = p.blobs.size() * sizeof(float) * lists + (p.code.operands.size() + p.code.blobs.size()) * sizeof(uint32_t) +
                 p.code.steps.size() * sizeof(Instruction) + p.spaces.size() * sizeof(Space) + p.field.nodes.size() * sizeof(Node);
  for (const auto& [node, faces] : p.hulls) bytes += faces.size() * sizeof(HullFace);
  if (p.identities) bytes += (p.identities->blobs.size() + p.identities->pieces.size()) * sizeof(LeafIdentity);
  if (p.motion) bytes += program_bytes(p.motion->end) + p.motion->middle.nodes.size() * sizeof(Node);
  return bytes;
}

} // namespace kelpie
