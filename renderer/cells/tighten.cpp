// A box is looked at as 64 parts, a part a lane. What a leaf can be at most in a part follows from its distance, which is
// convex: over a box it lies above its tangent plane at the centre. (Looking again at what is left leaves
// out another tenth of the cells that rays visit: trees are worth it, blobs are not.)

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "renderer/cells/tighten.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "renderer/cells/tighten.h"
#include "renderer/lanes/lanes-inl.h"
#include "renderer/lanes/solid_leaf-inl.h"
#include "renderer/lanes/tree_joins-inl.h"
#include "renderer/lanes/tree_leaf-inl.h"
#include "renderer/lanes/warp_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace kelpie {
namespace HWY_NAMESPACE {

/// A part is dropped by this margin of the threshold: here and when rays are solved, numbers are float.
constexpr float k_safe = 1 - 1e-4f;

/// Parts of a box, all of one size: their centres in lanes.
struct BoxParts {
  V3 centre;
  Vec3 half;
};

/// Part i of 4 x 4 x 4, with x first: where its centre lies, in sides of the whole box.
struct PartCentres {
  alignas(64) float at[3][64];

  constexpr PartCentres() : at() {
    for (int i = 0; i < 64; ++i) {
      const int part[] = {i % 4, i / 4 % 4, i / 16};
      for (int axis = 0; axis < 3; ++axis) at[axis][i] = (float(part[axis]) + 0.5f) / 4;
    }
  }
};
constexpr PartCentres k_part_centres;

/// Half of a part, and a little more: what rounding may add.
constexpr float k_half_part = 0.1255f;

/// Which of the 64 parts of a box may reach the threshold, as bits, given what the field is at most in each.
template <size_t k_vectors>
uint64_t parts_that_reach(const V (&most)[k_vectors], double threshold) {
  const V enough = set(static_cast<float>(threshold) * k_safe);
  uint64_t reached = 0;
  for (size_t i = 0; i < k_vectors; ++i) reached |= uint64_t{bits_of(hn::Ge(most[i], enough))} << (i * k_width);
  return reached;
}

/// Of ellipsoids: their matrices take a part to where it is within a box.
uint64_t parts_of_ellipsoids(const Box3& box, BlobList blobs, double threshold, TimeSpan time) {
  constexpr size_t k_vectors = 64 / k_width;
  const float middle_time = 0.5f * (time.start + time.end), half_time = 0.5f * (time.end - time.start);
  const V zero = hn::Zero(k_lanes);
  const Vec3 extent = box.extent(), half = k_half_part * extent;
  V most[k_vectors];
  for (V& sum : most) sum = zero;
  for (size_t i = 0; i < blobs.count && !blobs.is_padding(i); ++i) {
    const auto number = [&](uint32_t row) { return blobs.row(row)[i]; };
    Vec3 at, near; // it is somewhere on a segment
    for (const BlobRow axis : {blob_x, blob_y, blob_z}) {
      const float way = blobs.form.moves ? number(blobs.form.change_of(axis)) : 0;
      at[static_cast<int>(axis)] = number(axis) + middle_time * way;
      near[static_cast<int>(axis)] = half[static_cast<int>(axis)] + half_time * std::abs(way);
    }
    const auto entry = [&](BlobShapeRow row) { return number(blobs.form.row_of(row)); };
    const float xx = entry(shape_xx), yy = entry(shape_yy), zz = entry(shape_zz);
    const float xy = entry(shape_xy), xz = entry(shape_xz), yz = entry(shape_yz);
    const Vec3 rows[] = {{xx, xy, xz}, {xy, yy, yz}, {xz, yz, zz}};
    for (size_t j = 0; j < k_vectors; ++j) {
      V d[3];
      for (int axis = 0; axis < 3; ++axis)
        d[axis] = hn::MulAdd(hn::Load(k_lanes, k_part_centres.at[axis] + j * k_width), set(extent[axis]), set(box.lower[axis] - at[axis]));
      V q = set(number(blob_s));
      for (const Vec3& row : rows) {
        const V u = hn::MulAdd(set(row.x), d[0], hn::MulAdd(set(row.y), d[1], hn::Mul(set(row.z), d[2])));
        const V apart = hn::Max(hn::Sub(hn::Abs(u), set(glm::dot(glm::abs(row), near))), zero);
        q = hn::NegMulAdd(apart, apart, q);
      }
      q = hn::Max(q, zero);
      const V q2 = hn::Mul(q, q);
      most[j] =
          hn::Add(most[j], blobs.form.is_pure ? q2 : hn::Max(hn::Mul(q2, hn::MulAdd(set(number(blob_b)), q, set(number(blob_a)))), zero));
    }
  }
  return parts_that_reach(most, threshold);
}

uint64_t PartsOfBlobs(const Box3& box, BlobList blobs, double threshold, TimeSpan time) {
  if (!blobs.form.is_round) return parts_of_ellipsoids(box, blobs, threshold, time);
  // Squared distances are sums over the axes, and along an axis parts have four places only: all vectors of lanes share those
  // along x, those of a plane differ along y, and planes along z.
  constexpr size_t k_vectors = 64 / k_width, k_in_plane = 16 / k_width, k_in_row = std::max<size_t>(4 / k_width, 1);
  const float middle_time = 0.5f * (time.start + time.end), half_time = 0.5f * (time.end - time.start);
  const V zero = hn::Zero(k_lanes);
  const Vec3 extent = box.extent(), half = k_half_part * extent;
  const auto centre = [&](int axis, size_t i) {
    return hn::MulAdd(hn::Load(k_lanes, k_part_centres.at[axis] + i), set(extent[axis]), set(box.lower[axis]));
  };
  V most[k_vectors], centres_x[k_in_row], centres_y[k_in_plane], centres_z[4];
  for (size_t i = 0; i < k_in_row; ++i) centres_x[i] = centre(0, i * k_width);
  for (size_t i = 0; i < k_in_plane; ++i) centres_y[i] = centre(1, i * k_width);
  for (size_t i = 0; i < 4; ++i) centres_z[i] = centre(2, i * 16);
  for (V& sum : most) sum = zero;
  for (size_t i = 0; i < blobs.count && !blobs.is_padding(i); ++i) {
    const auto number = [&](uint32_t row) { return blobs.row(row)[i]; };
    const V k = set(number(blob_k));
    const auto squared = [&](V d) { return hn::Mul(k, hn::Mul(d, d)); };
    // How far the blob is from parts along an axis at least; squared, times k.
    const auto apart2 = [&](BlobRow axis, const V* from, size_t count, V* out) {
      // It is somewhere on a segment.
      const float way = blobs.form.moves ? number(blobs.form.change_of(axis)) : 0;
      const float middle = number(axis) + middle_time * way, along = half_time * std::abs(way);
      const V at = set(middle), near = set(half[static_cast<int>(axis)] + along);
      for (size_t j = 0; j < count; ++j) out[j] = squared(hn::Max(hn::Sub(hn::Abs(hn::Sub(from[j], at)), near), zero));
    };
    V x[k_in_row], y[k_in_plane], z[4];
    apart2(blob_x, centres_x, k_in_row, x), apart2(blob_y, centres_y, k_in_plane, y), apart2(blob_z, centres_z, 4, z);
    const V s = set(number(blob_s));
    for (size_t j = 0; j < k_in_plane; ++j) {
      const V in_plane = hn::Sub(s, hn::Add(x[j % k_in_row], y[j]));
      for (size_t plane = 0; plane < 4; ++plane) {
        const V q = hn::Max(hn::Sub(in_plane, z[plane]), zero), q2 = hn::Mul(q, q);
        V& sum = most[plane * k_in_plane + j];
        sum = hn::Add(sum, blobs.form.is_pure ? q2 : hn::Max(hn::Mul(q2, hn::MulAdd(set(number(blob_b)), q, set(number(blob_a)))), zero));
      }
    }
  }
  return parts_that_reach(most, threshold);
}

/// What the field of a tree is at most within the parts of a box. Places count from `centre`, as those of the tree do.
class TreeParts {
public:
  TreeParts(const TreeView& tree, const Vec3& centre, double threshold)
      : tree_(tree), centre_(centre), threshold_(static_cast<float>(threshold)) {}

  V most_within(const BoxParts& parts) {
    look_from(parts);
    const V zero = hn::Zero(k_lanes);
    const auto bound = [&](const TreeStep& step, Range& sum) {
      sum = {zero, zero, zero};
      const auto add = [&](V nearest) {
        sum.low = hn::Add(sum.low, hn::Min(nearest, zero)), sum.high = hn::Add(sum.high, hn::Max(nearest, zero));
      };
      if (step.kind == TreeStep::Kind::solid)
        add(nearest_to_solid(tree_.solids.leaves[step.first]));
      else
        for (uint32_t i = step.first; i < step.first + step.count; ++i) add(nearest_to_leaf(i));
    };
    const auto join = [&](const TreeStep& step, Range* operands) {
      operands[0] = join_ranges(step, threshold_, [&](uint32_t i) -> const Range& { return operands[i]; });
    };
    return fold_tree<Range>(tree_.steps, bound, join).high;
  }

private:
  /// The centre of a part in a space, and where the half sides of the part point there.
  struct Seen {
    V3 place, sides[3];
  };

  void look_from(const BoxParts& parts) {
    const V zero = hn::Zero(k_lanes);
    const V3& c = parts.centre;
    const V3 place{hn::Sub(c.x, set(centre_.x)), hn::Sub(c.y, set(centre_.y)), hn::Sub(c.z, set(centre_.z))};
    seen_[0] = {place, {{set(parts.half.x), zero, zero}, {zero, set(parts.half.y), zero}, {zero, zero, set(parts.half.z)}}};
    radius_ = set(glm::length(parts.half));
    const auto never = [](size_t) { return Curve{}; };
    for (int side = 0; side < 3 && !tree_.spaces.empty(); ++side) {
      Curve curves[k_tree_spaces];
      find_curves(tree_, {place, seen_[0].sides[side]}, 0, never, curves);
      for (size_t i = 0; i < tree_.spaces.size(); ++i) seen_[i + 1].place = curves[i].place, seen_[i + 1].sides[side] = curves[i].velocity;
    }
  }

  /// The potential where a part is nearest to the leaf, or nearer.
  V nearest_to_leaf(uint32_t i) const {
    const auto row = [&](uint32_t r) { return set(tree_.leaves[r * tree_.leaf_count + i]); };
    const Leaf leaf = Leaf::all(tree_, i);
    const Seen& from = seen_[static_cast<size_t>(tree_.row(leaf_space, i))];
    const Offset offset(leaf, place_in_frame(row, from.place));
    V least = hn::NegMulAdd(drift_within(row, radius_), radius_, offset.distance());
    for (const V3& side : from.sides) least = hn::Sub(least, hn::Abs(offset.rate(velocity_in_frame(row, side))));
    return leaf.potential(square_of_positive(least));
  }

  V nearest_to_solid(const SolidLeaf& leaf) const {
    const SolidView view(tree_.solids, leaf);
    const Seen& from = seen_[leaf.slot];
    V nearer = hn::Mul(hn::Min(set(leaf.drift), hn::Mul(set(leaf.bending), radius_)), radius_), distance = nearer, rate = nearer;
    for (const V3& side : from.sides) distance = view.distance(from.place, side, rate), nearer = hn::Add(nearer, hn::Abs(rate));
    return solid_potential(leaf, hn::Sub(distance, nearer));
  }

  TreeView tree_;
  Vec3 centre_;
  float threshold_;
  Seen seen_[k_tree_spaces + 1]; ///< in the world, then in the spaces of the tree
  V radius_;                     ///< of a part
};

/// The same for a tree.
uint64_t PartsOfTree(const Box3& box, const TreeView& tree, const Vec3& centre, double threshold) {
  TreeParts parts(tree, centre, threshold);
  const V enough = set(static_cast<float>(threshold) * k_safe);
  const Vec3 extent = box.extent();
  uint64_t reached = 0;
  for (size_t i = 0; i < 64; i += k_width) {
    const auto middle = [&](int axis) {
      return hn::MulAdd(hn::Load(k_lanes, k_part_centres.at[axis] + i), set(extent[axis]), set(box.lower[axis]));
    };
    const V most = parts.most_within({{middle(0), middle(1), middle(2)}, k_half_part * extent});
    reached |= uint64_t{bits_of(hn::Ge(most, enough))} << i;
  }
  return reached;
}

} // namespace HWY_NAMESPACE
} // namespace kelpie
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace kelpie {

namespace {

/// Those of the 64 parts that are first along an axis, and how far they are from the next.
struct Layer {
  uint64_t first;
  int shift;
};
constexpr Layer k_layers[] = {{0x1111111111111111, 1}, {0x000F000F000F000F, 4}, {0xFFFF, 16}};

/// The box around those of its 64 parts that are `reached` (bits).
Box3 around_parts(const Box3& box, uint64_t reached) {
  if (reached == 0) return {};
  const Vec3 extent = box.extent();
  Box3 out = box;
  for (int axis = 0; axis < 3; ++axis) {
    const auto is_reached = [&](int i) { return (reached & k_layers[axis].first << (i * k_layers[axis].shift)) != 0; };
    int low = 0, high = 4;
    while (!is_reached(low)) ++low;
    while (!is_reached(high - 1)) --high;
    if (low > 0) out.lower[axis] += 0.25f * float(low) * extent[axis];
    if (high < 4) out.upper[axis] = box.lower[axis] + 0.25f * float(high) * extent[axis];
  }
  return out;
}

} // namespace

HWY_EXPORT(PartsOfBlobs);
HWY_EXPORT(PartsOfTree);

Box3 tightened_to_blobs(const Box3& box, BlobList blobs, double threshold, TimeSpan time) {
  return around_parts(box, HWY_DYNAMIC_DISPATCH(PartsOfBlobs)(box, blobs, threshold, time));
}

Box3 tightened_to_tree(const Box3& box, const TreeView& tree, const Vec3& centre, double threshold) {
  const auto is_point_by_point = [](const TreeSpace& s) { return s.warp.form == LaneWarp::Form::none; };
  if (std::any_of(tree.spaces.begin(), tree.spaces.end(), is_point_by_point)) return box;
  return around_parts(box, HWY_DYNAMIC_DISPATCH(PartsOfTree)(box, tree, centre, threshold));
}

} // namespace kelpie
#endif
