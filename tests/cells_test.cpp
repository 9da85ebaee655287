// Cells are what is left of a field: whatever was pruned away must not show.
#include <gtest/gtest.h>

#include "renderer/cells/tighten.h"
#include "renderer/program/bound.h"
#include "renderer/trace/solve.h"
#include "tests/support/cell_field.h"
#include "tests/support/moving_field.h"

namespace kelpie {
namespace {

Vec3 random_point(Random& r, const Box3& box) { return Vec3(r.in(Box3d{Vec3d(box.lower), Vec3d(box.upper)})); }

bool is_warped(const Cell& cell) { return cell.tree && !cell.tree->spaces.empty(); }

/// What of the cells was compared with the whole field, and what was passed over.
struct Compared {
  size_t fields = 0;
  size_t points = 0, too_near = 0;           ///< off the surface; on it, but for rounding
  size_t normals = 0, without = 0;           ///< places of the surface; those that have no normal
  size_t in_warped_cells = 0, in_motion = 0; ///< of the points
};

/// Little was passed over.
void expect_nearly_all(const Compared& compared) {
  EXPECT_LT(compared.too_near, compared.points / 100);
  EXPECT_LT(compared.without, compared.normals / 5);
}

/// The normals of a cell and of the whole field at a place of the surface between two points. (Where the field is torn, nearly flat
/// or creased a place rounded to float has none to compare.)
void expect_same_normal(const ShapeCells& shape, const Cell& cell, Vec3d a, Vec3d b, double u, Compared& compared) {
  const FieldProgram& program = shape.program;
  const double threshold = threshold_at(program, u);
  const auto is_inside = [&](const Vec3d& p) { return whole_value(program, p, u) > threshold; };
  const bool a_is_inside = is_inside(a);
  for (int i = 0; i < 50; ++i) (is_inside(0.5 * (a + b)) == a_is_inside ? a : b) = 0.5 * (a + b);
  const Vec3 p(a);
  const auto whole_at = [&](const Vec3d& q) { return gradient(at(program, program.code, u), program.code, q); };
  const Vec3d whole = whole_at(Vec3d(p)), near = whole_at(Vec3d(p) + 1e-5 * (glm::length(a) + 1) * glm::normalize(whole));
  const double length = glm::length(whole);
  const bool is_torn = std::abs(whole_value(program, Vec3d(p), u) - threshold) > 1e-3 * threshold + 1e-6 * length;
  if (is_torn || !(length > 0.3) || !(glm::distance(whole, near) < 1e-3 * length)) {
    ++compared.without;
    return;
  }
  const Vec3d own(cell_gradient(shape, cell, p, shape.slab_start + float(u) / shape.slabs));
  ++compared.normals;
  EXPECT_LT(glm::distance(glm::normalize(own), whole / length), 0.02) << "at " << p.x << ' ' << p.y << ' ' << p.z;
}

/// Inside and outside are the same as of the whole field at random points and times of every cell, and so is the normal on the
/// surface.
void expect_pruned_equals_full(const ShapeCells& shape, Compared& compared, double precision = 1e-5) {
  const FieldProgram& program = shape.program;
  ++compared.fields;
  Random r(7);
  for (const Cell& cell : shape.cells) {
    const double u = program.motion ? (cell.window + r.uniform(0, 1)) / double(shape.windows()) : 0;
    const double threshold = threshold_at(program, u), noise = precision * threshold; // cells hold float32
    std::optional<Vec3d> inside, outside;
    for (int i = 0; i < 8; ++i) {
      const Vec3d p(random_point(r, cell.box));
      const double whole = whole_value(program, p, u);
      if (std::abs(whole - threshold) < noise) {
        ++compared.too_near;
        continue;
      }
      (whole > threshold ? inside : outside) = p;
      ASSERT_EQ(whole > threshold, cell_value(shape, cell, p, u) > threshold)
          << "at " << p.x << ' ' << p.y << ' ' << p.z << ", time " << u << ", content " << int(cell.content);
      ++compared.points, compared.in_warped_cells += is_warped(cell), compared.in_motion += program.motion != nullptr;
    }
    if (inside && outside) expect_same_normal(shape, cell, *inside, *outside, u, compared);
  }
}
void expect_pruned_equals_full(const SampledField& field, double threshold, Compared& compared, const CellLimits& limits = {},
                               double precision = 1e-5) {
  expect_pruned_equals_full(build_cells(compile(field, threshold), limits), compared, precision);
}

/// The cells of a field that moves, if it does and its maps can be interpolated.
std::optional<ShapeCells> moving_cells(const MovingField& field, double last_threshold, const CellLimits& limits = {},
                                       uint32_t windows = 1) {
  std::vector<FieldProgram> moments = compile({field.start, field.start, field.end}, std::array{1.0, 1.0, last_threshold});
  if (!set_in_motion(moments[0], std::move(moments[2]), &moments[1].field) || !moments[0].motion) return {};
  return build_cells(std::move(moments[0]), limits, windows);
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
  Compared compared;
  for (const Falloff f : {Falloff::quartic, Falloff::cubic, Falloff::wyvill})
    for (const BlobCloud& cloud : hard_clouds(f)) expect_pruned_equals_full(field_of(cloud), 1, compared);
  EXPECT_GT(compared.points, 50'000u);
  EXPECT_GT(compared.normals, 2000u);
  expect_nearly_all(compared);
}

TEST(Cells, PrunedEqualsFullInTrees) {
  Compared compared;
  for (unsigned trial = 0; trial < 300 && !HasFailure(); ++trial) {
    SCOPED_TRACE(trial);
    Random r(trial);
    SampledField field;
    random_tree(r, 1 + int(trial % 4), field);
    expect_pruned_equals_full(field, trial % 2 ? 1 : 0.6, compared, k_small_cells);
  }
  EXPECT_GT(compared.points, 10'000u);
  EXPECT_GT(compared.normals, 700u);
  expect_nearly_all(compared);
}

TEST(Cells, PrunedEqualsFullOfEveryKind) {
  const EveryKind kinds;
  Compared compared;
  for (unsigned trial = 0; trial < 90 && !HasFailure(); ++trial) { // each operator over each warp
    SCOPED_TRACE(trial);
    Random r(trial);
    const SampledField field = kinds.random_field(trial, r);
    // Of a solid far larger than its radius of influence float32 leaves less.
    expect_pruned_equals_full(field, trial % 2 ? 1 : 0.6, compared, trial % 3 ? CellLimits{} : k_small_cells, 1e-3);
  }
  EXPECT_GT(compared.points, 20'000u);
  EXPECT_GT(compared.in_warped_cells, compared.points / 10);
  EXPECT_GT(compared.normals, 1000u);
  expect_nearly_all(compared);
}

TEST(Cells, PrunedEqualsFullInMotion) {
  const EveryKind kinds(Metamorphoses::left_out);
  Compared compared;
  const auto look = [&](const MovingField& field, double last_threshold, const CellLimits& limits, uint32_t windows, double precision) {
    if (const auto shape = moving_cells(field, last_threshold, limits, windows)) expect_pruned_equals_full(*shape, compared, precision);
  };
  for (const BlobCloud& cloud : hard_clouds(Falloff::wyvill))
    for (const CloudMotion moves : {CloudMotion::centres, CloudMotion::everything, CloudMotion::some})
      look(moving_cloud(cloud, 0.5, moves), 1, {}, 2, 1e-5);
  EXPECT_EQ(compared.fields, 12u);
  EXPECT_GT(compared.in_motion, 50'000u) << "of clouds";
  expect_nearly_all(compared);
  compared = {};
  for (unsigned trial = 0; trial < 16 && !HasFailure(); ++trial) {
    SCOPED_TRACE(trial);
    look(random_moving_tree(trial, 1 + int(trial % 3), MovingTree::with_points), trial % 2 ? 1 : 1.2, k_small_cells, 1, 1e-5);
    look(random_moving_field(kinds, trial), 1, {}, 1, 1e-3);
  }
  EXPECT_GT(compared.fields, 24u) << "of 32 trees; the others stand, or their maps cannot be interpolated";
  EXPECT_GT(compared.in_motion, 1000u) << "of trees";
  EXPECT_GT(compared.normals, 50u);
  expect_nearly_all(compared);
}

// What a box is cut back by holds nothing of the surface. (Boxes of cells are cut back already: this goes on with it.)
class Tightening : public testing::Test {
protected:
  void look(const ShapeCells& shape) {
    const FieldProgram& program = shape.program;
    Random r(11);
    for (const Cell& cell : shape.cells) {
      const double first = r.uniform(0, 1), last = r.uniform(first, 1), threshold = threshold_range(program).lo;
      const Box3 part{random_point(r, cell.box), cell.box.upper};
      const bool is_cloud = cell.content == Cell::Content::blobs;
      const TimeSpan time = program.motion && is_cloud ? TimeSpan{float(first), float(last)} : TimeSpan{};
      const std::optional<Box3> cut = cut_back(shape, cell, part, time);
      ++(cut ? cells_ : other_cells_);
      moving_trees_ += cut && cell.content == Cell::Content::moving_tree;
      if (!cut) continue;
      const Box3 tight = *cut;
      for (int i = 0; i < 20; ++i) {
        const Vec3 p = random_point(r, part);
        const double u = program.motion ? r.uniform(double(time.start), double(time.end)) : 0;
        ++points_;
        if (tight.contains(p)) continue;
        ++cut_, cut_in_warps_ += is_warped(cell), cut_in_motion_ += program.motion != nullptr;
        ASSERT_LT(cell_value(shape, cell, Vec3d(p), u), threshold) << "time " << u;
      }
    }
  }

  /// What is left of a part of a cell. Code is not cut back, nor are blobs that grow or fade.
  static std::optional<Box3> cut_back(const ShapeCells& shape, const Cell& cell, const Box3& part, TimeSpan time) {
    const double threshold = threshold_range(shape.program).lo;
    switch (cell.content) {
    case Cell::Content::blobs:
      if (cell.blobs.form.moves && !cell.blobs.form.is_pure) return {};
      return tightened_to_blobs(part, cell.blobs, threshold, time);
    case Cell::Content::tree: return tightened_to_tree(part, shape.tree(cell), cell.centre, threshold);
    case Cell::Content::moving_tree:
      if (const auto wide = make_wide_tree(shape.program, shape.code(cell), part, cell.centre))
        return tightened_to_tree(part, wide->view(), cell.centre, threshold);
      return {};
    case Cell::Content::code: return {};
    }
    return {};
  }

  int cells_ = 0, other_cells_ = 0, moving_trees_ = 0, points_ = 0, cut_ = 0, cut_in_warps_ = 0, cut_in_motion_ = 0;
};

TEST_F(Tightening, CutsNothingOffTrees) {
  const EveryKind kinds;
  for (unsigned trial = 0; trial < 90; ++trial) {
    SCOPED_TRACE(trial);
    Random r(trial);
    look(build_cells(compile(kinds.random_field(trial, r), trial % 2 ? 1 : 0.6)));
  }
  EXPECT_LT(other_cells_, cells_ / 2);
  EXPECT_GT(cut_, points_ / 10);
  EXPECT_GT(cut_in_warps_, 10'000);
}

TEST_F(Tightening, CutsNothingOffClouds) {
  for (const Falloff f : {Falloff::quartic, Falloff::wyvill})
    for (const BlobCloud& cloud : hard_clouds(f)) look(build_cells(compile(field_of(cloud), 1)));
  EXPECT_EQ(other_cells_, 0);
  EXPECT_GT(cut_, points_ / 10);
}

TEST_F(Tightening, CutsNothingOffWhatMoves) {
  for (const BlobCloud& cloud :
       {coincident_cloud(Falloff::quartic), thin_cloud(Falloff::quartic), positive(ellipsoid_cloud(Falloff::quartic))})
    for (const CloudMotion moves : {CloudMotion::centres, CloudMotion::some})
      look(moving_cells(moving_cloud(cloud, 0.8, moves), 1).value());
  EXPECT_EQ(other_cells_, 0);
  int trees = 0;
  for (unsigned trial = 0; trial < 60; ++trial) // parts of them stand
    if (const auto shape = moving_cells(random_moving_tree(trial, 2, MovingTree::with_points), 1.2)) look(*shape), ++trees;
  EXPECT_GT(trees, 50);
  EXPECT_GT(cells_, 1000);
  EXPECT_GT(cut_in_motion_, points_ / 10);
}

/// As creatures move: their skeletons and the frames of those, but no operators, and no warps that are not affine.
MovingField with_standing_operators(MovingField field) {
  for (size_t i = 0; i < field.start.nodes.size(); ++i)
    std::visit(
        [&]<class K>(const K& kind) {
          auto& end = std::get<K>(field.end.nodes[i]);
          if constexpr (Operator<K> || MovingWarp<K>)
            end = kind;
          else if constexpr (Skeleton<K>)
            end.weight = std::copysign(end.weight, kind.weight);
        },
        field.start.nodes[i]);
  return field;
}

TEST_F(Tightening, CutsNothingOffMovingTrees) {
  const EveryKind kinds(Metamorphoses::left_out);
  for (unsigned i = 0; i < 240; ++i) { // each leaf, below each warp and each operator
    SCOPED_TRACE(i);
    const MovingField field =
        i % 2 ? random_moving_field(kinds, 61 * (i / 2)) : random_moving_tree(i, 1 + int(i % 3), MovingTree::with_points);
    if (const auto shape = moving_cells(with_standing_operators(field), 1)) look(*shape);
  }
  EXPECT_GT(moving_trees_, 10'000);
  EXPECT_GT(cut_in_motion_, points_ / 10);
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
      Compared compared;
      expect_pruned_equals_full(field_of(cloud), 1, compared, limits);
      EXPECT_GT(compared.points, 50u);
    }
    EXPECT_EQ(steps, 3);
    EXPECT_LT(before, 0.75 * double(finest));
  }
}

TEST(Cells, TakeWhatTheyAreFromTheBudget) {
  const auto build = [](BuildBudget& budget) {
    CellLimits limits;
    limits.budget = &budget;
    return build_cells(compile(field_of(thin_cloud(Falloff::quartic)), 1), limits);
  };
  BuildBudget ample(size_t(1) << 40);
  const ShapeCells shape = build(ample);
  const size_t needed = shape.bytes() + shape.cells.size() * k_tree_bytes_per_cell;
  BuildBudget enough(needed), too_little(needed - 1);
  EXPECT_EQ(build(enough).cells.size(), shape.cells.size());
  EXPECT_THROW(build(too_little), BuildBudget::OutOfMemory);
}

// Wherever the field crosses the threshold there is a cell: points close together, one on either side.
TEST(Cells, HoldTheWholeSurface) {
  int crossings = 0, fields = 0;
  for (unsigned trial = 0; trial < 60; ++trial) {
    SCOPED_TRACE(trial);
    Random r(trial);
    SampledField field;
    random_tree(r, 1 + int(trial % 3), field);
    const ShapeCells shape = build_cells(compile(field, 1), k_small_cells);
    const FieldProgram& program = shape.program;
    if (program.support.is_empty()) continue;
    const int before = crossings;
    const auto inside = [&](const Vec3d& p) { return evaluate(program, program.code, Point3<double>{p.x, p.y, p.z}) > 1; };
    for (int i = 0; i < 300; ++i) {
      Vec3d a = r.in(program.support), b = r.in(program.support);
      if (inside(a) == inside(b)) continue;
      ++crossings;
      for (int k = 0; k < 50; ++k) (inside(0.5 * (a + b)) == inside(a) ? a : b) = 0.5 * (a + b);
      const bool held =
          std::any_of(shape.cells.begin(), shape.cells.end(), [&](const Cell& c) { return c.box.padded(1e-5f).contains(Vec3(a)); });
      EXPECT_TRUE(held) << "no cell at " << a.x << ' ' << a.y << ' ' << a.z;
    }
    fields += crossings > before;
  }
  EXPECT_GT(crossings, 700);
  EXPECT_GT(fields, 30) << "with a surface, of 60";
}

// Bounds of every step of a program contain samples of it, in boxes of any size.
TEST(Cells, BoundsContainSamples) {
  int fields = 0, telling = 0;
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
    ++fields, telling += ranges.back().width() > 0;
    for (int i = 0; i < 50; ++i) {
      const Vec3d p = r.in(box);
      const double f = evaluate(program, program.code, Point3<double>{p.x, p.y, p.z});
      EXPECT_LE(ranges.back().lo - 1e-5, f); // 1e-5: sums of blobs are bounded in float32
      EXPECT_GE(ranges.back().hi + 1e-5, f);
    }
  }
  EXPECT_GT(fields, 200);
  EXPECT_GT(telling, fields / 3);
}

// The derivative of the map to a warped space differs within a box by no more than is said: on this the bounds of trees are built.
TEST(Trees, TurningBoundsHowMuchDerivativesDiffer) {
  FieldKinds::for_each([]<template <class> class Kind>() {
    if constexpr (Warp<Kind<SampledMode>>) {
      SCOPED_TRACE(Kind<SampledMode>::k_name);
      int bounded = 0;
      double closest = 0;
      for (unsigned trial = 0; trial < 500; ++trial) {
        Random r(trial);
        SampledField field;
        Kind<SampledMode> warp = random_kind<Kind>(r);
        if constexpr (requires { warp.rate; }) warp.rate *= 60; // degrees
        Point<SampledMode> point;
        point.radius = 10, point.weight = 2;
        warp.child = add(field, point);
        add(field, warp);
        const FieldProgram program = compile(std::move(field), 1);
        ASSERT_EQ(program.spaces.size(), 2u);
        const float size = float(r.log_uniform(1e-3, 0.3));
        const Vec3 centre = kelpie::random_point(r, 1.5);
        const Box3 box{centre - size, centre + size};
        const double most = turning(program, 1, box);
        if (!(most < 1e6)) continue; // torn, or creased
        ++bounded;
        const auto derivative = [&] {
          const Vec3d p(random_point(r, box));
          using D = Dual<double, 3>;
          SpacePoints<D> points;
          points.begin(program);
          const Point3<D> q = points.at(program, 1, {D::variable(p.x, 0), D::variable(p.y, 1), D::variable(p.z, 2)});
          return std::array{q.x.d, q.y.d, q.z.d};
        };
        for (int i = 0; i < 10; ++i) {
          const auto a = derivative(), b = derivative();
          double sum = 0;
          for (size_t row = 0; row < 3; ++row)
            for (size_t column = 0; column < 3; ++column) sum += square(a[row][column] - b[row][column]);
          EXPECT_LE(std::sqrt(sum), most + 1e-9) << trial;
          if (most > 1e-6) closest = std::max(closest, std::sqrt(sum) / most);
        }
      }
      EXPECT_GT(bounded, 150);
      EXPECT_GT(closest, 0.3);
    }
  });
}

} // namespace
} // namespace kelpie
