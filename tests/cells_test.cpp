// Cells are what is left of a field: whatever was pruned away must not show.
#include <numeric>

#include <gtest/gtest.h>

#include "renderer/cells/tighten.h"
#include "renderer/program/bound.h"
#include "renderer/trace/solve.h"
#include "tests/support/every_kind.h"

namespace kelpie {
namespace {

/// The potential of a leaf of a tree, by the formula of tree.h.
double leaf_value(const TreeView& tree, size_t i, const Vec3d& p) {
  const auto row = [&](uint32_t r) { return double(tree.leaves[r * tree.leaf_count + i]); };
  const auto coordinate = [&](uint32_t r) { return glm::dot(Vec3d(row(r), row(r + 1), row(r + 2)), p) + row(r + 3); };
  const double across = std::hypot(coordinate(leaf_xx), coordinate(leaf_yx)), z = coordinate(leaf_zx);
  const double s = std::clamp(z - row(leaf_slope) * across, row(leaf_s_low), row(leaf_s_high));
  const double d = std::max(0.0, std::hypot(across, z - s) - (row(leaf_r) - row(leaf_sine) * s));
  const double q = std::max(0.0, 1 - row(leaf_k) * d * d);
  return q * q * (row(leaf_a) + row(leaf_b) * q);
}

/// From the nearest point of a part to a point, by tree.h.
Vec3d from_part(const Solids& solids, const SolidPart& part, Vec3d q, bool has_height) {
  const Vec3d low(part.x_low, part.y_low, part.z_low), high(part.x_high, part.y_high, part.z_high);
  Vec3d r = q - glm::clamp(q, low, high);
  if (!has_height) r.z = 0;
  if (part.edge_count == 0) return r;
  std::vector<Vec2d> corners;
  for (const SolidEdge& e : std::span(solids.edges + part.first_edge, part.edge_count)) corners.push_back({e.x, e.y});
  const Vec2d across = from_nearest(corners, Vec2d(q));
  return {across.x, across.y, r.z};
}

/// The potential of a solid, by tree.h.
double solid_value(const Solids& solids, const SolidLeaf& leaf, const Vec3d& p) {
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
    if (leaf.form == SolidLeaf::Form::arc && leaf.past_end_x * q.x + leaf.past_end_y * std::abs(q.y) + leaf.past_end_0 > 0)
      d = glm::length(Vec3d(q.x - leaf.end_x, std::abs(q.y) - leaf.end_y, q.z));
  }
  if (leaf.form == SolidLeaf::Form::hull && !is_outside) d = 0;
  const double q = std::max(0.0, 1 - leaf.k * square(std::max(0.0, d - leaf.growth)));
  return q * q * (leaf.a + leaf.b * q);
}

template <class Function>
double r_join(double a, double b, double threshold) {
  return threshold * Function::join(std::max(0.0, a) / threshold, std::max(0.0, b) / threshold);
}

double tree_value(const TreeView& tree, const Vec3d& p, double threshold) {
  std::vector<double> stack;
  for (const TreeStep& step : tree.steps) {
    double result = 0;
    if (step.kind == TreeStep::Kind::leaves) {
      for (uint32_t i = 0; i < step.count; ++i) result += leaf_value(tree, step.first + i, p);
    } else if (step.kind == TreeStep::Kind::solid) {
      result = solid_value(tree.solids, tree.solids.leaves[step.first], p);
    } else if (step.kind == TreeStep::Kind::local_blend) {
      const std::span<const double> f = std::span(stack).last(step.count);
      const double most = *std::max_element(f.begin(), f.end() - 1), sum = std::accumulate(f.begin(), f.end() - 1, 0.0);
      result = most + std::clamp(f.back(), 0.0, 1.0) * (sum - most);
      stack.resize(stack.size() - step.count);
    } else {
      const auto operands = stack.end() - step.count;
      result = *operands;
      for (auto f = operands + 1; f != stack.end(); ++f) switch (step.kind) {
        case TreeStep::Kind::maximum: result = std::max(result, *f); break;
        case TreeStep::Kind::minimum: result = std::min(result, *f); break;
        case TreeStep::Kind::difference: result = std::min(result, 2 * threshold - *f); break;
        case TreeStep::Kind::sum: result += *f; break;
        case TreeStep::Kind::hyper_blend:
          result = std::pow(std::pow(std::max(0.0, result), step.exponent) + std::pow(std::max(0.0, *f), step.exponent), 1 / step.exponent);
          break;
        case TreeStep::Kind::r_union: result = r_join<r_function::Unite>(result, *f, threshold); break;
        case TreeStep::Kind::r_intersection: result = r_join<r_function::Intersect>(result, *f, threshold); break;
        case TreeStep::Kind::r_difference: result = r_join<r_function::Intersect>(result, 2 * threshold - *f, threshold); break;
        default: ADD_FAILURE() << "no join";
        }
      if (step.kind == TreeStep::Kind::difference) result = std::max(0.0, result);
      stack.erase(operands, stack.end());
    }
    stack.push_back(result);
  }
  EXPECT_EQ(stack.size(), 1u);
  return stack.back();
}

/// A sum of blobs that stand, by the formula of blob_list.h.
double blobs_value(const BlobList& blobs, const Vec3d& p) {
  EXPECT_FALSE(blobs.form.moves);
  double sum = 0;
  for (size_t i = 0; i < blobs.count; ++i) {
    const auto number = [&](BlobRow row) { return double(blobs.row(row)[i]); };
    const Vec3d d = p - Vec3d(number(blob_x), number(blob_y), number(blob_z));
    const double q = std::max(0.0, number(blob_s) - number(blob_k) * glm::dot(d, d));
    sum += blobs.form.is_pure ? q * q : q * q * (number(blob_a) + number(blob_b) * q);
  }
  return sum;
}

/// The field as a cell has it.
double cell_value(const ShapeCells& shape, const Cell& cell, const Vec3d& p) {
  switch (cell.content) {
  case Cell::Content::tree: return tree_value(*cell.tree, p - Vec3d(cell.centre), shape.program.threshold);
  case Cell::Content::code: return evaluate(shape.program, *cell.code, Point3<double>{p.x, p.y, p.z});
  case Cell::Content::blobs: return blobs_value(cell.blobs, p);
  case Cell::Content::moving_tree: break;
  }
  ADD_FAILURE() << "it moves";
  return 0;
}

Vec3 random_point(Random& r, const Box3& box) { return Vec3(r.in(Box3d{Vec3d(box.lower), Vec3d(box.upper)})); }

bool is_warped(const Cell& cell) { return cell.tree && !cell.tree->spaces.empty(); }

/// Inside and outside are the same as of the whole field at random points of every cell; on the surface so
/// is the gradient.
void expect_pruned_equals_full(const SampledField& field, double threshold, const CellLimits& limits = {}, double precision = 1e-5) {
  const ShapeCells shape = build_cells(compile(field, threshold), limits);
  const FieldProgram& program = shape.program;
  Random r(7);
  const double noise = precision * threshold; // cells hold float32
  size_t compared = 0;
  for (const Cell& cell : shape.cells) {
    if (is_warped(cell)) continue;
    for (int i = 0; i < 8; ++i) {
      const Vec3d p(random_point(r, cell.box));
      const double whole = evaluate(program, program.code, Point3<double>{p.x, p.y, p.z});
      if (std::abs(whole - threshold) < noise) continue;
      ASSERT_EQ(whole > threshold, cell_value(shape, cell, p) > threshold) << "at " << p.x << ' ' << p.y << ' ' << p.z;
      ++compared;
    }
  }
  EXPECT_TRUE(compared > 0 || std::all_of(shape.cells.begin(), shape.cells.end(), is_warped));
}

// Blobs are put in another order when they are compiled, the same in all moments; the field stays what it was.
TEST(Cells, BlobsAreSortedByPlace) {
  Random r(2);
  BlobCloud cloud;
  for (int i = 0; i < 3000; ++i)
    cloud.push_back({Vec3(r.direction() * r.uniform(0, 3)), float(r.uniform(0.2, 0.4)), float(r.uniform(-0.5, 1)), Falloff(i % 2)});
  BlobCloud later = cloud;
  for (Blob& b : later) b.centre += Vec3(r.direction());
  const std::vector<FieldProgram> programs = compile({field_of(cloud), field_of(later)}, std::array{1.0, 1.0});
  EXPECT_EQ(programs[0].code.blobs, programs[1].code.blobs);
  const auto steps = [](const auto& place, size_t count) {
    double sum = 0;
    for (size_t i = 1; i < count; ++i) sum += glm::distance(place(i), place(i - 1));
    return sum;
  };
  const BlobArrays& sorted = programs[0].blobs;
  ASSERT_EQ(sorted.size(), cloud.size());
  EXPECT_LT(steps([&](size_t i) { return Vec3(sorted.x[i], sorted.y[i], sorted.z[i]); }, sorted.size()),
            0.2 * steps([&](size_t i) { return cloud[i].centre; }, cloud.size()));
  for (const auto& [program, blobs] : {std::pair{&programs[0], &cloud}, std::pair{&programs[1], &later}})
    for (int i = 0; i < 4; ++i) {
      const Vec3d p = r.direction() * r.uniform(0, 3);
      double sum = 0;
      for (const Blob& b : *blobs) {
        const FieldProgram one = compile(field_of(BlobCloud{b}), 1);
        sum += evaluate(one, one.code, Point3<double>{p.x, p.y, p.z});
      }
      EXPECT_NEAR(evaluate(*program, program->code, Point3<double>{p.x, p.y, p.z}), sum, 1e-4);
    }
}

TEST(CellMemory, StaysWhereItIs) {
  Random r(4);
  CellMemory all, other;
  std::vector<std::pair<float*, size_t>> lists;
  size_t numbers = 0;
  for (int i = 0; i < 3000; ++i) {
    CellMemory& memory = i % 3 ? all : other;
    const size_t count = 2 * static_cast<size_t>(r.uniform(0, i % 500 == 0 ? 5e5 : 1000));
    if (i % 5 == 0) memory.add_numbers(77), memory.drop_numbers(77);
    float* at = memory.add_numbers(count);
    std::fill(at, at + count, float(i));
    lists.push_back({at, count}), numbers += count;
  }
  all.join(std::move(other));
  EXPECT_EQ(all.bytes(), numbers * sizeof(float));
  for (size_t i = 0; i < lists.size(); ++i) {
    const auto [at, count] = lists[i];
    EXPECT_EQ(std::count(at, at + count, float(i)), std::ptrdiff_t(count));
  }
}

TEST(Cells, PrunedEqualsFullInClouds) {
  for (const Falloff f : {Falloff::quartic, Falloff::cubic, Falloff::wyvill})
    for (const BlobCloud& cloud : {coincident_cloud(f), thin_cloud(f), negative_cloud(f)}) expect_pruned_equals_full(field_of(cloud), 1);
}

TEST(Cells, PrunedEqualsFullInTrees) {
  for (unsigned trial = 0; trial < 300; ++trial) {
    SCOPED_TRACE(trial);
    Random r(trial);
    SampledField field;
    random_tree(r, 1 + int(trial % 4), field);
    expect_pruned_equals_full(field, trial % 2 ? 1 : 0.6, k_small_cells);
    if (HasFatalFailure()) return;
  }
}

TEST(Cells, PrunedEqualsFullOfEveryKind) {
  const EveryKind kinds;
  for (unsigned trial = 0; trial < 90; ++trial) { // each operator over each warp
    SCOPED_TRACE(trial);
    Random r(trial);
    const SampledField field = kinds.random_field(trial, r);
    // Of a solid far larger than its radius of influence float32 leaves less.
    expect_pruned_equals_full(field, trial % 2 ? 1 : 0.6, trial % 3 ? CellLimits{} : k_small_cells, 1e-3);
    if (HasFatalFailure()) return;
  }
}

// What a box is cut back by holds nothing of the surface. (Boxes of cells are cut back already: this goes on with it.)
TEST(Cells, WhatABoxIsCutBackByIsEmpty) {
  const EveryKind kinds;
  int compared = 0, cut = 0;
  const auto look = [&](const SampledField& field, double threshold) {
    const ShapeCells shape = build_cells(compile(field, threshold));
    Random r(11);
    for (const Cell& cell : shape.cells) {
      if (is_warped(cell) || cell.content == Cell::Content::code) continue;
      const Box3 part{random_point(r, cell.box), cell.box.upper};
      const Box3 tight = cell.content == Cell::Content::tree ? tightened_to_tree(part, *cell.tree, cell.centre, threshold)
                                                             : tightened_to_blobs(part, cell.blobs, threshold);
      for (int i = 0; i < 20; ++i) {
        const Vec3 p = random_point(r, part);
        ++compared;
        if (tight.contains(p)) continue;
        ++cut;
        ASSERT_LT(cell_value(shape, cell, Vec3d(p)), threshold);
      }
    }
  };
  for (unsigned trial = 0; trial < 90; ++trial) {
    SCOPED_TRACE(trial);
    Random r(trial);
    look(kinds.random_field(trial, r), trial % 2 ? 1 : 0.6);
  }
  for (const Falloff f : {Falloff::quartic, Falloff::wyvill})
    for (const BlobCloud& cloud : {coincident_cloud(f), thin_cloud(f), negative_cloud(f)}) look(field_of(cloud), 1);
  EXPECT_GT(cut, compared / 10);
}

// Cells of any size are the field; larger ones take less memory.
TEST(Cells, CoarserCellsTakeLess) {
  for (const BlobCloud& cloud : {coincident_cloud(Falloff::quartic), thin_cloud(Falloff::quartic), negative_cloud(Falloff::quartic)}) {
    CellLimits limits;
    const size_t finest = build_cells(compile(field_of(cloud), 1), limits).bytes();
    size_t before = finest;
    int steps = 0;
    while (make_coarser(limits)) {
      ++steps;
      const size_t now = build_cells(compile(field_of(cloud), 1), limits).bytes();
      EXPECT_LE(now, before);
      before = now;
      expect_pruned_equals_full(field_of(cloud), 1, limits);
    }
    EXPECT_EQ(steps, 3);
    EXPECT_LT(before, 0.75 * double(finest));
  }
}

TEST(Cells, TakeWhatTheyAreFromTheBudget) {
  const auto build = [](MemoryBudget& budget) {
    CellLimits limits;
    limits.budget = &budget;
    return build_cells(compile(field_of(thin_cloud(Falloff::quartic)), 1), limits);
  };
  MemoryBudget ample(size_t(1) << 40);
  const ShapeCells shape = build(ample);
  const size_t needed = shape.bytes() + shape.cells.size() * k_tree_bytes_per_cell;
  MemoryBudget enough(needed), too_little(needed - 1);
  EXPECT_EQ(build(enough).cells.size(), shape.cells.size());
  EXPECT_THROW(build(too_little), MemoryBudget::Exceeded);
}

// Wherever the field crosses the threshold there is a cell: points close together, one on either side.
TEST(Cells, HoldTheWholeSurface) {
  for (unsigned trial = 0; trial < 60; ++trial) {
    SCOPED_TRACE(trial);
    Random r(trial);
    SampledField field;
    random_tree(r, 1 + int(trial % 3), field);
    const ShapeCells shape = build_cells(compile(field, 1), k_small_cells);
    const FieldProgram& program = shape.program;
    if (program.support.is_empty()) continue;
    const auto inside = [&](const Vec3d& p) { return evaluate(program, program.code, Point3<double>{p.x, p.y, p.z}) > 1; };
    for (int i = 0; i < 300; ++i) {
      Vec3d a = r.in(program.support), b = r.in(program.support);
      if (inside(a) == inside(b)) continue;
      for (int k = 0; k < 50; ++k) (inside(0.5 * (a + b)) == inside(a) ? a : b) = 0.5 * (a + b);
      const bool held =
          std::any_of(shape.cells.begin(), shape.cells.end(), [&](const Cell& c) { return c.box.padded(1e-5f).contains(Vec3(a)); });
      EXPECT_TRUE(held) << "no cell at " << a.x << ' ' << a.y << ' ' << a.z;
    }
  }
}

// Bounds of every step of a program contain samples of it, in boxes of any size.
TEST(Cells, BoundsContainSamples) {
  for (unsigned trial = 0; trial < 300; ++trial) {
    SCOPED_TRACE(trial);
    Random r(trial);
    SampledField field;
    random_tree(r, 1 + int(trial % 3), field);
    const FieldProgram program = compile(field, 1);
    if (program.support.is_empty()) continue;
    const Vec3d centre = r.in(program.support), half(r.log_uniform(1e-3, 1), r.log_uniform(1e-3, 1), r.log_uniform(1e-3, 1));
    const Box3d box{centre - half, centre + half};
    std::vector<Interval> ranges;
    bound(program, program.code, box, ranges);
    for (int i = 0; i < 50; ++i) {
      const Vec3d p = r.in(box);
      const double f = evaluate(program, program.code, Point3<double>{p.x, p.y, p.z});
      EXPECT_LE(ranges.back().lo - 1e-5, f); // 1e-5: sums of blobs are bounded in float32
      EXPECT_GE(ranges.back().hi + 1e-5, f);
    }
  }
}

} // namespace
} // namespace kelpie
