// What a field is made of at a point is what the formulas of methods.md say, by a reference that shares no code: in the whole program,
// in the cell of a hit, in the cells of a texture, below warps and in motion.
#include <map>

#include <gtest/gtest.h>

#include "renderer/cells/value_cells.h"
#include "renderer/program/materials_at.h"
#include "renderer/trace/tracer.h"
#include "tests/reference/materials.h"
#include "tests/support/moving_field.h"
#include "tests/support/random_rays.h"
#include "tests/support/reference_scene.h"

namespace kelpie {
namespace {

constexpr CompileOptions k_with_identities{.with_identities = true};

/// A tree of operators that mix, above random trees; about every other node has a material of its own.
SampledField random_matter(unsigned trial) {
  Random r(trial);
  SampledField field;
  const auto children = [&](int count) {
    std::vector<unsigned> nodes;
    for (int i = 0; i < count; ++i) nodes.push_back(random_tree(r, 1 + r.below(3), field));
    return nodes;
  };
  switch (trial % 6) {
  case 0: {
    HyperBlend<SampledMode> mix = random_kind<HyperBlend>(r);
    mix.n = float(r.log_uniform(0.7, 8)), mix.children = children(3);
    add(field, mix);
    break;
  }
  case 1: {
    LocalBlend<SampledMode> mix;
    mix.children = children(2), mix.region = random_tree(r, 0, field);
    add(field, mix);
    break;
  }
  case 2: {
    Twist<SampledMode> twist = random_kind<Twist>(r);
    twist.child = children(1)[0];
    add(field, twist);
    break;
  }
  case 3: {
    Difference<SampledMode> smooth;
    smooth.formula = BooleanFormula::smooth, smooth.children = children(2);
    Blend<SampledMode> blend;
    blend.children = {add(field, smooth), children(1)[0]};
    add(field, blend);
    break;
  }
  case 4: {
    Metamorphosis<SampledMode> mix = random_kind<Metamorphosis>(r);
    const std::vector<unsigned> objects = children(int(mix.objects.size()));
    for (size_t j = 0; j < objects.size(); ++j) mix.objects[j].field = objects[j];
    add(field, mix);
    break;
  }
  default: random_tree(r, 4, field);
  }
  field.materials.resize(field.nodes.size());
  for (uint32_t i = 0; i < field.nodes.size(); ++i)
    if (r.below(2)) field.materials[i] = {i};
  return field;
}

/// The shares of each material, and the points that they are looked at.
struct Shares {
  std::map<uint32_t, double> of;
  std::map<uint32_t, Vec3d> places; ///< weighted, so that one of several places is not preferred
  double total = 0;

  void add(uint32_t material, double share, const Vec3d& at) { of[material] += share, places[material] += share * at, total += share; }
};

Shares expected(const SampledField& field, const Vec3d& p, double threshold) {
  Shares shares;
  for (const reference::MaterialPart& m : reference::materials(*reference_of(field), {p.x, p.y, p.z}, threshold))
    shares.add(uint32_t(m.material), m.share, {m.position.x, m.position.y, m.position.z});
  return shares;
}

Shares found(const FieldProgram& program, const CodeView& code, const Vec3d& p) {
  std::vector<MaterialAt> parts;
  materials_at(program, code, p, {}, parts);
  Shares shares;
  for (const MaterialAt& m : parts) shares.add(m.material.index, m.share, Vec3d(m.position));
  return shares;
}

void expect_equal(const Shares& found, const Shares& expected) {
  EXPECT_LE(found.total, 1 + 1e-5);
  EXPECT_NEAR(found.total, expected.total, 1e-5);
  for (const auto& [material, share] : expected.of) {
    const auto at = found.of.find(material);
    ASSERT_TRUE(at != found.of.end() || share < 1e-5) << material << " " << share;
    if (at == found.of.end()) continue;
    EXPECT_NEAR(at->second, share, 1e-5) << material;
    EXPECT_LE(glm::distance(found.places.at(material), expected.places.at(material)), 1e-4) << material;
  }
}

TEST(Materials, AreThoseOfTheFormulas) {
  int compared = 0, mixed = 0;
  for (unsigned trial = 0; trial < 200; ++trial) {
    SCOPED_TRACE(trial);
    const SampledField field = random_matter(trial);
    const FieldProgram program = compile(field, 1, k_with_identities);
    const ValueCells cells(compile(field, 1, k_with_identities), {Vec3d(-1), Vec3d(1)}); // some points lie beyond
    Random r(trial);
    for (int i = 0; i < 500; ++i) {
      const Vec3d p = r.in(Box3d{Vec3d(-1.1), Vec3d(1.1)});
      const Shares truth = expected(field, p, 1);
      expect_equal(found(program, program.code, p), truth);
      expect_equal(found(cells.program(), cells.code_at(p), p), truth);
      compared += truth.total > 0, mixed += truth.of.size() > 1;
      if (HasFailure()) return;
    }
  }
  EXPECT_GT(compared, 20'000);
  EXPECT_GT(mixed, 4'000);
}

TEST(Materials, AreTheSameInTheCellOfAHit) {
  int compared = 0;
  for (unsigned trial = 0; trial < 40; ++trial) {
    SCOPED_TRACE(trial);
    FrameScene scene = scene_of(random_matter(trial));
    const Tracer tracer(scene, trial % 2 ? CellLimits{} : k_small_cells);
    Random r(trial);
    SolveCounters counters;
    for (int i = 0; i < 200; ++i) {
      Hit hit;
      if (!tracer.intersect(random_ray(r, tracer.bounds(), {}, true), counters, hit)) continue;
      const CodeView& code = *hit.slab->cells[hit.cell].code;
      expect_equal(found(hit.slab->program, code, Vec3d(hit.position)), expected(scene.shapes[0].field, Vec3d(hit.position), 1));
      ++compared;
      if (HasFailure()) return;
    }
  }
  EXPECT_GT(compared, 1000);
}

/// The same, with points and translations elsewhere: all compiled numbers are linear in these.
SampledField moved(SampledField field, Random& r) {
  for (auto& node : field.nodes) {
    if (auto* point = std::get_if<Point<SampledMode>>(&node)) point->centre += random_point(r, 0.2);
    if (auto* translate = std::get_if<Translate<SampledMode>>(&node)) translate->by += random_point(r, 0.3);
  }
  return field;
}

TEST(Materials, GoWithWhatMoves) {
  int compared = 0, moving = 0;
  for (unsigned trial = 0; trial < 60; ++trial) {
    SCOPED_TRACE(trial);
    Random r(trial);
    const MovingField field{random_matter(trial), moved(random_matter(trial), r)};
    std::vector<FieldProgram> programs = compile({field.start, field.end}, std::array{1.0, 1.0}, k_with_identities);
    const Code code = programs[0].code;
    if (!set_in_motion(programs[0], std::move(programs[1]))) continue;
    moving += programs[0].motion != nullptr;
    for (const double u : {0.0, 0.3, 0.8})
      for (int i = 0; i < 60; ++i) {
        const Vec3d p = r.in(Box3d{Vec3d(-1.1), Vec3d(1.1)});
        const Shares truth = expected(moving_field_at(field, u), p, 1);
        expect_equal(found(at_with_materials(programs[0], code, u), code, p), truth);
        compared += truth.total > 0;
        if (HasFailure()) return;
      }
  }
  EXPECT_GT(compared, 2000);
  EXPECT_GT(moving, 40);
}

/// A point of a liquid has the materials of where its matter was and will be.
TEST(Materials, FlowWithALiquid) {
  const auto cloud = [](float x) { return BlobCloud{{Vec3(x, 0, 0), 1, 2, Falloff::quartic}, {Vec3(x, 0.6f, 0), 1, 2, Falloff::quartic}}; };
  for (const float progress : {0.f, 0.25f, 1.f}) {
    Liquid<SampledMode> liquid;
    liquid.morph = std::make_shared<LiquidChain>(cloud(-1), cloud(1), Correspondence::transport, VolumeRule::free);
    liquid.progress = progress, liquid.from_material = {7}, liquid.to_material = {8};
    Rotate<SampledMode> turned; // materials live in the space of the liquid
    turned.axis = Vec3(0, 1, 0), turned.angle = 90;
    SampledField field;
    turned.child = add(field, liquid);
    add(field, turned);
    field.materials.resize(field.nodes.size());
    const FieldProgram program = compile(field, 1, k_with_identities);
    const Vec3d local(-1 + 2 * progress + 0.1, 0.2, 0.15);
    const Shares shares = found(program, program.code, turned.parent_from_child()(local));
    EXPECT_NEAR(shares.total, 1, 1e-5);
    const std::pair<uint32_t, double> ends[] = {{7, 1 - progress}, {8, progress}};
    for (const auto& [material, share] : ends) {
      if (share == 0) {
        EXPECT_EQ(shares.of.count(material), 0u);
        continue;
      }
      EXPECT_NEAR(shares.of.at(material), share, 1e-5);
      const Vec3d there = local + Vec3d(material == 7 ? -2 * progress : 2 - 2 * progress, 0, 0);
      EXPECT_LE(glm::distance(shares.places.at(material) / share, there), 1e-4) << progress;
    }
  }
}

/// A thousand regions are looked at by the few that are near.
TEST(Materials, OfATextureAreFoundByAFewElements) {
  Random r(3);
  SampledField field;
  Union<SampledMode> all;
  for (int i = 0; i < 1000; ++i) {
    Point<SampledMode> p;
    p.centre = random_point(r), p.radius = 0.15f, p.weight = 2;
    all.children.push_back(add(field, p));
  }
  add(field, all);
  const ValueCells cells(compile(field, 1, k_with_identities), {Vec3d(-1), Vec3d(1)});
  double steps = 0;
  for (int i = 0; i < 1000; ++i) steps += double(cells.code_at(Vec3d(random_point(r))).steps.size());
  EXPECT_LT(steps / 1000, 12);
}

} // namespace
} // namespace kelpie
