// What a moving element may be anywhere in a slab of time, told of its middle.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>

#include "renderer/program/motion.h"

namespace kelpie {

/// What a skeleton is in a tree: its weight, its radius of influence, and how much nearer than it is its places count as.
struct Extent {
  double weight, radius, nearer = 0;
};
/// The same of a blob.
struct BlobExtent {
  BlobNumbers numbers;
  double nearer = 0;
};

/// Extents of elements in the middle of a slab, so that the potential which they have in a place of a cell lies between 0 and what it is
/// with them, at all times of the slab. A motion cannot leave the space between its ends; so what is seen from the middle moves by half
/// of the way. Nothing where that is not known: below warps that move, and where a weight changes its sign.
class Widening {
public:
  Widening(const FieldProgram& slab, const Box3& cell) : slab_(slab), cell_(cell) {}

  /// Whether an operator stands.
  bool stands(const Instruction& step) const { return !motion().nodes[step.node]; }

  std::optional<BlobExtent> of_blob(uint32_t i, const Instruction& step) const {
    const BlobNumbers s = slab_.blobs[i], e = motion().end.blobs[i];
    const std::optional<double> moved = space_moves(step.space);
    const auto most = [](float x, float y) -> std::optional<float> {
      if (x >= 0 && y >= 0) return std::max(x, y);
      if (x <= 0 && y <= 0) return std::min(x, y);
      return {};
    };
    const std::optional<float> a = most(s.a, e.a), b = most(s.b, e.b);
    const bool is_same = s.a == e.a && s.b == e.b; // its polynomial may change its sign then, but not by the time
    if (!moved || (!is_same && !(a && b && *a * *b >= 0))) return {};
    const Vec3d from(s.x, s.y, s.z), to(e.x, e.y, e.z), middle = 0.5 * (from + to);
    BlobNumbers wide{static_cast<float>(middle.x),
                     static_cast<float>(middle.y),
                     static_cast<float>(middle.z),
                     std::min(s.k, e.k),
                     is_same ? s.a : *a,
                     is_same ? s.b : *b,
                     s.shape};
    const float in_ball = std::sqrt(wide.k); // an ellipsoid that turns stays in the ball that it touches
    if (s.shape != e.shape) wide.shape = {in_ball, in_ball, in_ball, 0, 0, 0};
    return BlobExtent{wide, safe(*moved + 0.5 * glm::distance(from, to))};
  }

  /// Of the skeleton of a step, which is `middle` in the middle of the slab.
  template <class Kind>
  std::optional<Extent> of_skeleton(const Instruction& step, const Kind& middle) const {
    const auto& a = std::get<Kind>(slab_.field.nodes[step.node]);
    const auto& b = std::get<Kind>(motion().end.field.nodes[step.node]);
    const std::optional<double> moved = space_moves(step.space);
    if (!moved) return {};
    if (!motion().nodes[step.node]) return Extent{middle.weight, reach_of(middle), safe(*moved)};
    if constexpr (MovingSkeleton<Kind> && requires { a.displacement_from(b); }) {
      const double weight = std::abs(a.weight) > std::abs(b.weight) ? a.weight : b.weight;
      if (a.weight * b.weight < 0) return {};
      if (SignedDistance<Kind> && !(a.weight == b.weight && reach_of(a) == reach_of(b))) return {}; // may be below 0
      return Extent{weight, std::max(reach_of(a), reach_of(b)),
                    safe(*moved + std::max(displacement(middle, a, {}), displacement(middle, b, {})))};
    }
    return {};
  }

private:
  const Motion& motion() const { return *slab_.motion; }
  /// Trees count in float.
  static double safe(double moved) { return moved * (1 + 1e-5); }

  /// How far points of the cell are in a space from where they are in the middle, at most. Farthest are corners: the way is linear in
  /// the place.
  std::optional<double> space_moves(uint32_t index) const {
    if (!motion().spaces[index]) return 0;
    const Space& a = slab_.spaces[index];
    if (a.warp != Space::k_no_warp || a.parent != 0) return {};
    const Affine &from = a.local_from_parent, &to = motion().end.spaces[index].local_from_parent;
    const Affine way{to.linear - from.linear, to.offset - from.offset};
    double farthest = 0;
    for (int corner = 0; corner < 8; ++corner) {
      Vec3d p;
      for (int i = 0; i < 3; ++i) p[i] = corner >> i & 1 ? cell_.upper[i] : cell_.lower[i];
      farthest = std::max(farthest, 0.5 * glm::length(way(p)));
    }
    return farthest;
  }

  const FieldProgram& slab_;
  const Box3 cell_;
};

} // namespace kelpie
