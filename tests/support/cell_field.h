// The field as a cell has it, by the formulas that renderer/cells says, in double and step by step.
#pragma once

#include <numeric>

#include <gtest/gtest.h>

#include "renderer/cells/cells.h"
#include "renderer/program/motion.h"

namespace kelpie {

/// The potential of a leaf of a tree, by the formula of tree.h.
inline double leaf_value(const TreeView& tree, size_t i, const Vec3d& p) {
  const auto row = [&](uint32_t r) { return double(tree.leaves[r * tree.leaf_count + i]); };
  const auto coordinate = [&](uint32_t r) { return glm::dot(Vec3d(row(r), row(r + 1), row(r + 2)), p) + row(r + 3); };
  const double across = std::hypot(coordinate(leaf_xx), coordinate(leaf_yx)), z = coordinate(leaf_zx);
  const double s = std::clamp(z - row(leaf_slope) * across, row(leaf_s_low), row(leaf_s_high));
  const double d = std::max(0.0, std::hypot(across, z - s) - (row(leaf_r) - row(leaf_sine) * s));
  const double q = std::max(0.0, 1 - row(leaf_k) * d * d);
  return q * q * (row(leaf_a) + row(leaf_b) * q);
}

/// From the nearest point of a part to a point, by tree.h.
inline Vec3d from_part(const Solids& solids, const SolidPart& part, Vec3d q, bool has_height) {
  const Vec3d low(part.x_low, part.y_low, part.z_low), high(part.x_high, part.y_high, part.z_high);
  Vec3d r = q - glm::clamp(q, low, high);
  if (!has_height) r.z = 0;
  if (part.edge_count == 0) return r;
  std::vector<Vec2d> corners;
  for (const SolidEdge& e : std::span(solids.edges + part.first_edge, part.edge_count)) corners.push_back({e.x, e.y});
  const Vec2d across = from_nearest(corners, Vec2d(q));
  return {across.x, across.y, r.z};
}

/// How far outside a rectangle a point is, or how far inside as a number below 0.
inline double signed_distance_to_part(const SolidPart& part, const Vec3d& q, bool has_height) {
  double side = std::max({part.x_low - q.x, q.x - part.x_high, part.y_low - q.y, q.y - part.y_high});
  if (has_height) side = std::max({side, part.z_low - q.z, q.z - part.z_high});
  return side;
}

/// The potential of a solid, by tree.h.
inline double solid_value(const Solids& solids, const SolidLeaf& leaf, const Vec3d& p) {
  double d = std::numeric_limits<double>::infinity();
  bool is_outside = false;
  for (const SolidPart& part : std::span(solids.parts + leaf.first_part, leaf.part_count)) {
    const auto coordinate = [&](int r) {
      return glm::dot(Vec3d(part.frame[r], part.frame[r + 1], part.frame[r + 2]), p) + part.frame[r + 3];
    };
    const Vec3d q(coordinate(0), coordinate(4), coordinate(8)), turned(std::hypot(q.x, q.y), q.z, 0);
    const bool is_turned = leaf.form == SolidLeaf::Form::turned || leaf.form == SolidLeaf::Form::arc;
    d = std::min(d, glm::length(from_part(solids, part, is_turned ? turned : q, !is_turned)));
    is_outside |= q.z > 0;
    if (leaf.is_signed) {
      const double side = signed_distance_to_part(part, is_turned ? turned : q, !is_turned);
      if (side < 0) d = side;
    }
    if (leaf.form == SolidLeaf::Form::half_space) d = q.z;
    if (leaf.form == SolidLeaf::Form::arc && leaf.past_end_x * q.x + leaf.past_end_y * std::abs(q.y) + leaf.past_end_0 > 0)
      d = glm::length(Vec3d(q.x - leaf.end_x, std::abs(q.y) - leaf.end_y, q.z));
  }
  if (leaf.form == SolidLeaf::Form::hull && !is_outside) d = 0;
  const SolidPotential& f = leaf.potential;
  d -= leaf.growth;
  if (f.form == SolidPotential::Form::ramp) return std::clamp(f.a - f.b * d, double(f.low), double(f.high));
  const double q = std::max(0.0, 1 - f.k * square(std::max(0.0, d)));
  return q * q * (f.a + f.b * q);
}

template <class Function>
double r_join(double a, double b, double threshold) {
  return threshold * Function::join(std::max(0.0, a) / threshold, std::max(0.0, b) / threshold);
}

/// A point as the leaves of a cell's tree see it: from the centre of the cell, and from its image in each warped space.
inline std::vector<Vec3d> places_in(const FieldProgram& program, const TreeView& tree, const Vec3& centre, const Vec3d& p) {
  std::vector<Vec3d> places{p - Vec3d(centre)};
  SpacePoints<double> points;
  points.begin(program);
  for (const TreeSpace& s : tree.spaces) {
    const Point3<double> image = points.at(program, s.space, {p.x, p.y, p.z});
    places.push_back(Vec3d(image.x, image.y, image.z) - Vec3d(s.centre));
  }
  return places;
}

/// The field of a tree, by the steps of tree_view.h.
inline double tree_value(const TreeView& tree, const std::vector<Vec3d>& places, double threshold) {
  std::vector<double> stack;
  for (const TreeStep& step : tree.steps) {
    double result = 0;
    if (step.kind == TreeStep::Kind::leaves) {
      for (uint32_t i = 0; i < step.count; ++i)
        result += leaf_value(tree, step.first + i, places[static_cast<size_t>(tree.row(leaf_space, step.first + i))]);
    } else if (step.kind == TreeStep::Kind::solid) {
      const SolidLeaf& leaf = tree.solids.leaves[step.first];
      result = solid_value(tree.solids, leaf, places[leaf.slot]);
    } else if (step.join == Join::local_blend) {
      const std::span<const double> f = std::span(stack).last(step.count);
      const double most = *std::max_element(f.begin(), f.end() - 1), sum = std::accumulate(f.begin(), f.end() - 1, 0.0);
      result = most + std::clamp(f.back(), 0.0, 1.0) * (sum - most);
      stack.resize(stack.size() - step.count);
    } else {
      const auto operands = stack.end() - step.count;
      result = *operands;
      for (auto f = operands + 1; f != stack.end(); ++f) switch (step.join) {
        case Join::maximum: result = std::max(result, *f); break;
        case Join::minimum: result = std::min(result, *f); break;
        case Join::difference: result = std::min(result, 2 * threshold - *f); break;
        case Join::sum: result += *f; break;
        case Join::hyper_blend:
          result = std::pow(std::pow(std::max(0.0, result), step.exponent) + std::pow(std::max(0.0, *f), step.exponent), 1 / step.exponent);
          break;
        case Join::r_union: result = r_join<r_function::Unite>(result, *f, threshold); break;
        case Join::r_intersection: result = r_join<r_function::Intersect>(result, *f, threshold); break;
        case Join::r_difference: result = r_join<r_function::Intersect>(result, 2 * threshold - *f, threshold); break;
        case Join::local_blend: break;
        }
      if (step.join == Join::difference) result = std::max(0.0, result);
      stack.erase(operands, stack.end());
    }
    stack.push_back(result);
  }
  EXPECT_EQ(stack.size(), 1u);
  return stack.back();
}

/// A sum of blobs at a time of the slab, by the formula of blob_list.h.
inline double blobs_value(const BlobList& blobs, const Vec3d& p, double u) {
  const bool is_pure = blobs.form.is_pure;
  double sum = 0;
  for (size_t i = 0; i < blobs.count; ++i) {
    const auto number = [&](BlobRow row) {
      const bool moves = blobs.form.moves && row != blob_s && (!is_pure || row < blob_s);
      return double(blobs.row(row)[i]) + (moves ? u * double(blobs.row(blobs.form.change_of(row))[i]) : 0);
    };
    const Vec3d d = p - Vec3d(number(blob_x), number(blob_y), number(blob_z));
    double d2 = number(blob_k) * glm::dot(d, d);
    if (!blobs.form.is_round) {
      const auto entry = [&](BlobShapeRow row) {
        const bool moves = blobs.form.moves && !is_pure;
        return double(blobs.row(blobs.form.row_of(row))[i]) + (moves ? u * double(blobs.row(blobs.form.change_of(row))[i]) : 0);
      };
      const double xy = entry(shape_xy), xz = entry(shape_xz), yz = entry(shape_yz);
      const Vec3d in_ball(entry(shape_xx) * d.x + xy * d.y + xz * d.z, xy * d.x + entry(shape_yy) * d.y + yz * d.z,
                          xz * d.x + yz * d.y + entry(shape_zz) * d.z);
      d2 = glm::dot(in_ball, in_ball);
    }
    const double q = std::max(0.0, number(blob_s) - d2);
    sum += is_pure ? q * q : q * q * (number(blob_a) + number(blob_b) * q);
  }
  return sum;
}

/// The field as a cell has it, by the formulas of cells.h, at a time of the slab.
inline double cell_value(const ShapeCells& shape, const Cell& cell, const Vec3d& p, double u = 0) {
  const FieldProgram& program = shape.program;
  switch (cell.content) {
  case Cell::Content::blobs: return blobs_value(cell.blobs, p, u);
  case Cell::Content::tree: return tree_value(*cell.tree, places_in(program, *cell.tree, cell.centre, p), threshold_at(program, u));
  case Cell::Content::moving_tree:
  case Cell::Content::code: break;
  }
  return evaluate(at(program, *cell.code, u), *cell.code, Point3<double>{p.x, p.y, p.z});
}

/// The field of the whole program.
inline double whole_value(const FieldProgram& program, const Vec3d& p, double u = 0) {
  return evaluate(at(program, program.code, u), program.code, Point3<double>{p.x, p.y, p.z});
}

} // namespace kelpie
