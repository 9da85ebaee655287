// Whose the leaves are that make a surface: identities survive folding, sorting, expansion, pruning and motion.
#include <set>

#include <gtest/gtest.h>

#include "renderer/trace/tracer.h"
#include "tests/support/every_kind.h"
#include "tests/support/moving_field.h"

namespace kelpie {
namespace {

constexpr CompileOptions k_with_identities{.with_identities = true};

/// Leaves in a fixed order. Those without influence to speak of are left out: where operands are nearly equal, rounding decides.
std::vector<LeafAt> in_order(std::vector<LeafAt> leaves) {
  std::erase_if(leaves, [](const LeafAt& leaf) { return std::abs(leaf.influence) < 1e-9 || std::abs(leaf.potential) < 1e-9; });
  std::sort(leaves.begin(), leaves.end(), [](const LeafAt& a, const LeafAt& b) {
    return std::tuple(a.whose.node, a.whose.part, a.potential) < std::tuple(b.whose.node, b.whose.part, b.potential);
  });
  return leaves;
}

/// Looks at a shape from all sides. At each hit, the leaves that the hit's cell names are those that the whole program names.
class HitLeaves {
public:
  explicit HitLeaves(const FrameScene& scene, CellLimits limits = {}) : tracer_(scene, asking(limits)) {}

  /// So many rays; returns how many hit.
  int look(int rays) const {
    if (tracer_.bounds().is_empty()) return 0;
    Random r(5);
    SolveCounters counters;
    int hits = 0;
    for (int i = 0; i < rays; ++i) {
      const Box3& box = tracer_.bounds();
      const Vec3 target = box.centre() + Vec3(r.direction()) * (float(r.uniform(0, 0.4)) * box.diagonal());
      Ray ray;
      ray.origin = box.centre() + Vec3(r.direction()) * box.diagonal();
      ray.direction = glm::normalize(target - ray.origin), ray.time = float(r.uniform(0, 1));
      Hit hit;
      if (!tracer_.intersect(ray, counters, hit)) continue;
      ++hits;
      compare(hit, ray.time);
      if (testing::Test::HasFatalFailure()) break;
    }
    return hits;
  }

private:
  static CellLimits asking(CellLimits limits) {
    limits.with_identities = true;
    return limits;
  }

  void compare(const Hit& hit, float time) const {
    std::vector<LeafAt> of_cell, of_program;
    tracer_.leaves_at(hit, of_cell);
    const ShapeCells& shape = tracer_.cells().shape(0, time);
    const CodeView whole = shape.program.code;
    leaves_at(at(shape.program, whole, shape.slab_time(time)), whole, Vec3d(hit.position), of_program);
    of_cell = in_order(of_cell), of_program = in_order(of_program);
    ASSERT_FALSE(of_cell.empty());
    ASSERT_EQ(of_cell.size(), of_program.size());
    for (size_t i = 0; i < of_cell.size(); ++i) {
      ASSERT_EQ(of_cell[i].whose, of_program[i].whose);
      ASSERT_NEAR(of_cell[i].potential, of_program[i].potential, 1e-6 * std::abs(of_program[i].potential));
      ASSERT_NEAR(of_cell[i].influence, of_program[i].influence, 1e-6 * std::max(1.0, std::abs(of_program[i].influence)));
    }
  }

  Tracer tracer_;
};

BlobCloud large_cloud() {
  BlobCloud cloud;
  Random r(3);
  for (int i = 0; i < 3000; ++i)
    cloud.push_back({Vec3(r.direction() * r.uniform(0, 3)), float(r.uniform(0.2, 0.4)), float(r.uniform(-0.3, 1)), Falloff(i % 3)});
  return cloud;
}

TEST(Identities, AtHitsOfClouds) {
  EXPECT_GT(HitLeaves(scene_of(field_of(large_cloud()))).look(500), 200);
  EXPECT_GT(HitLeaves(scene_of(field_of(thin_cloud(Falloff::quartic))), k_small_cells).look(500), 50);
}

TEST(Identities, AtHitsOfTrees) {
  int hits = 0;
  for (unsigned trial = 0; trial < 150; ++trial) {
    SCOPED_TRACE(trial);
    Random r(trial);
    SampledField field;
    random_tree(r, 1 + int(trial % 4), field);
    hits += HitLeaves(scene_of(field, trial % 2 ? 1 : 0.6f), trial % 3 ? CellLimits{} : k_small_cells).look(60);
    if (HasFatalFailure()) return;
  }
  EXPECT_GT(hits, 1000);
}

TEST(Identities, AtHitsOfEveryKind) {
  const EveryKind kinds;
  int hits = 0;
  for (unsigned trial = 0; trial < 90; ++trial) {
    SCOPED_TRACE(trial);
    Random r(trial);
    hits += HitLeaves(scene_of(kinds.random_field(trial, r), trial % 2 ? 1 : 0.6f)).look(40);
    if (HasFatalFailure()) return;
  }
  EXPECT_GT(hits, 500);
}

TEST(Identities, AtHitsOfWhatMoves) {
  CellLimits limits;
  limits.slabs = 1;
  int hits = 0;
  for (unsigned trial = 0; trial < 60; ++trial) {
    SCOPED_TRACE(trial);
    const MovingField field = random_moving_tree(trial, 1 + int(trial % 3));
    hits += HitLeaves(moving_scene(field, {1, trial % 2 ? 1 : 0.9f}), limits).look(40);
    if (HasFatalFailure()) return;
  }
  EXPECT_GT(hits, 200);
}

// Similarities are folded into blobs, and blobs are sorted; what the identity names is still where the scene has it.
TEST(Identities, OfBlobsSurviveFoldingAndSorting) {
  SampledField field = field_of(large_cloud());
  Scale<SampledMode> scale;
  scale.by = Vec3(1.5f), scale.child = static_cast<unsigned>(field.root());
  Rotate<SampledMode> rotate;
  rotate.axis = {1, 2, 3}, rotate.angle = 0.7f, rotate.child = add(field, scale);
  Translate<SampledMode> translate;
  translate.by = {3, -1, 2}, translate.child = add(field, rotate);
  SampledField later = field;
  add(field, translate);
  translate.by = {4, 0, 2};
  add(later, translate);
  const std::vector<FieldProgram> programs = compile({field, later}, std::array{1.0, 1.0}, k_with_identities);
  for (const auto& [program, scene] : {std::pair{&programs[0], &field}, std::pair{&programs[1], &later}}) {
    const Affine place =
        std::get<Translate<SampledMode>>(scene->nodes.back()).parent_from_child() * rotate.parent_from_child() * scale.parent_from_child();
    ASSERT_EQ(program->identities->blobs.size(), program->blobs.size());
    std::set<std::pair<uint32_t, uint32_t>> met;
    for (uint32_t i = 0; i < program->blobs.size(); ++i) {
      const auto [node, part, place_of_material] = program->identities->blobs[i];
      const Blob& blob = (*std::get<Blobs<SampledMode>>(scene->nodes[node]).cloud)[part];
      const BlobNumbers now = program->blob(i);
      ASSERT_LT(glm::distance(place(Vec3d(blob.centre)), Vec3d(now.x, now.y, now.z)), 1e-5);
      met.insert({node, part});
    }
    EXPECT_EQ(met.size(), 3000u);
  }
}

TEST(Identities, OfPiecesAreTheirPrimitives) {
  Random r(2);
  SampledField field;
  Union<SampledMode> both;
  Revolution<SampledMode> vase;
  vase.profile = {{1, 0, 0.1f}, {2, 1, 0.2f}, {1, 2, 0.1f}}, vase.detail = 0.01f;
  both.children = {add(field, random_leaf<Segment>(r)), add(field, vase)};
  add(field, both);
  const FieldProgram program = compile(field, 1, k_with_identities);
  size_t pieces = 0;
  for (const Instruction& step : program.code.steps) {
    if (step.kind != Instruction::Kind::skeleton) continue;
    const LeafIdentity whose = program.identity_of(step.node);
    if (whose.node == both.children[0]) continue;
    ASSERT_EQ(whose.node, both.children[1]);
    EXPECT_EQ(whose.part, pieces++);
  }
  EXPECT_GT(pieces, 1u);
}

// In a blend all leaves have an influence of 1, so the field is the sum of their potentials.
TEST(Identities, PotentialsOfABlendAddUp) {
  const FieldProgram program = compile(field_of(large_cloud()), 1, k_with_identities);
  Random r(8);
  std::vector<LeafAt> leaves;
  int several = 0;
  for (int i = 0; i < 200; ++i) {
    const Vec3d p = r.direction() * r.uniform(0, 3);
    leaves_at(program, program.code, p, leaves);
    double sum = 0;
    for (const LeafAt& leaf : leaves) {
      EXPECT_EQ(leaf.influence, 1);
      sum += leaf.potential;
    }
    EXPECT_NEAR(sum, evaluate(program, program.code, Point3<double>{p.x, p.y, p.z}), 1e-9);
    several += leaves.size() > 1;
  }
  EXPECT_GT(several, 50);
}

TEST(Identities, CostNothingWhereNobodyAsks) {
  const ShapeCells shape = build_cells(compile(field_of(large_cloud()), 1));
  EXPECT_EQ(shape.program.identities, nullptr);
  for (const Cell& cell : shape.cells) ASSERT_EQ(cell.code, nullptr);
  EXPECT_GT(build_cells(compile(field_of(large_cloud()), 1, k_with_identities)).bytes(), shape.bytes());
}

} // namespace
} // namespace kelpie
