// Rays that go straight through several shapes, nested, overlapping and touching: at each surface they know
// what they enter or leave, and between surfaces what they are in. The reference judges every stretch.
#include "renderer/trace/surroundings.h"
#include "tests/support/examination.h"

namespace kelpie {
namespace {

/// Shapes in one scene, and the reference's picture of each.
struct Shapes {
  explicit Shapes(const std::vector<SampledField>& fields) {
    for (const SampledField& field : fields) {
      frame.shapes.push_back(scene_of(field).shapes.front());
      nodes.push_back(reference_of(field));
    }
  }

  FrameScene frame;
  std::vector<reference::NodePtr> nodes;
};

constexpr double k_threshold = 1;

/// A ball of this radius: its point's radius of influence is 1.85 times as large.
SampledField ball(const Vec3& centre, double radius) {
  return field_of({Blob{centre, float(radius / std::sqrt(1 - std::sqrt(0.5))), 2, Falloff::quartic}});
}

struct WalkTally {
  int surfaces = 0, wrong_surfaces = 0, sides = 0, wrong_sides = 0, endless = 0, deepest = 0, in_packets = 0;
};

class Walker {
public:
  Walker(const Shapes& media, const CellLimits& limits)
      : media_(media), tracer_(media.frame, limits), box_(tracer_.bounds().padded(0.01f * tracer_.bounds().diagonal())) {}

  /// Follows a ray through all surfaces to the end of the scene.
  void walk(Ray ray, WalkTally& tally) const {
    constexpr int k_most_surfaces = 200;
    SolveCounters counters;
    for (int i = 0; i < k_most_surfaces; ++i) {
      const int depth = check_sides(ray, tally);
      tally.deepest = std::max(tally.deepest, depth);
      Hit hit;
      const bool found = tracer_.intersect(ray, counters, hit);
      check_packet(ray, found, hit, tally);
      check_surface(ray, found, hit, tally);
      if (!found) return;
      EXPECT_EQ(hit.is_leaving, ray.inside.contains(hit.shape));
      ++tally.surfaces;
      ray = depart(ray, hit, ray.direction, Side::far);
    }
    ++tally.endless;
  }

  WalkTally walk_many(int rays) const {
    WalkTally tally;
    std::vector<reference::Leaf> leaves;
    for (const reference::NodePtr& node : media_.nodes) collect_leaves(*node, leaves);
    for (int i = 0; i < rays; ++i) {
      Random r(i);
      Ray ray = random_ray(r, box_, leaves, i % 3 != 0);
      ray.inside = Surroundings(tracer_, {ray.origin, ray.origin}).shapes_around(ray.origin, 0);
      walk(ray, tally);
    }
    return tally;
  }

  const Tracer& tracer() const { return tracer_; }

private:
  double value_at(size_t shape, const Vec3& p) const { return value(*media_.nodes[shape], reference_of(p), k_threshold); }

  /// Compares what the ray believes to be in with where it is; returns in how many shapes.
  int check_sides(const Ray& ray, WalkTally& tally) const {
    int depth = 0;
    for (size_t s = 0; s < media_.nodes.size(); ++s) {
      const double f = value_at(s, ray.origin) / k_threshold;
      depth += ray.inside.contains(uint32_t(s));
      // Within the offset of a surface that the ray did not stop at, the next answer sets things right.
      if (std::abs(f - 1) > 0.05) ++tally.sides, tally.wrong_sides += ray.inside.contains(uint32_t(s)) != (f > 1);
    }
    return depth;
  }

  /// In a packet the ray gets the same answer but for rounding.
  void check_packet(const Ray& ray, bool found, const Hit& hit, WalkTally& tally) const {
    SolveCounters counters;
    Hit again;
    const bool found_again = tracer_.intersect(std::span(&ray, 1), counters, &again) != 0;
    if (found != found_again || !found || hit.shape != again.shape) return; // a graze may go either way
    EXPECT_EQ(hit.is_leaving, again.is_leaving);
    ++tally.in_packets;
  }

  /// No surface of any shape may be passed over before the answer, and the answer must be one.
  void check_surface(const Ray& ray, bool found, const Hit& hit, WalkTally& tally) const {
    const reference::Ray exact{reference_of(ray.origin), reference_of(ray.direction)};
    const Stretch stretch = inside(exact, box_);
    if (!(stretch.from < stretch.to)) {
      tally.wrong_surfaces += found;
      return;
    }
    for (size_t s = 0; s < media_.nodes.size(); ++s) {
      const bool is_hit = found && hit.shape == s;
      const double to = found && !is_hit ? std::min(stretch.to, double(hit.t)) : stretch.to;
      if (!(stretch.from < to)) continue;
      reference::Profile profile = reference::along_ray(*media_.nodes[s], exact, stretch.from, to, k_threshold);
      if (ray.inside.contains(uint32_t(s))) profile = reflected(std::move(profile), k_threshold);
      const double answer = is_hit ? double(hit.t) : std::numeric_limits<double>::infinity();
      tally.wrong_surfaces += reference::judge(profile, k_threshold, box_.diagonal(), answer) != Verdict::right;
    }
  }

  const Shapes& media_;
  Tracer tracer_;
  Box3 box_;
};

/// Sends rays through the shapes; what they met is added to `met`.
void expect_right(const std::vector<SampledField>& fields, int rays, WalkTally& met, const CellLimits& limits = {}) {
  const Shapes media(fields);
  const WalkTally tally = Walker(media, limits).walk_many(rays);
  EXPECT_EQ(tally.wrong_surfaces, 0);
  EXPECT_EQ(tally.wrong_sides, 0);
  EXPECT_EQ(tally.endless, 0);
  EXPECT_GT(2 * tally.sides, tally.surfaces);
  EXPECT_GE(tally.in_packets, tally.surfaces - 2 - tally.surfaces / 1000);
  met.surfaces += tally.surfaces, met.deepest = std::max(met.deepest, tally.deepest);
}

// A bubble in a drop in a glass: six surfaces in a row, known in advance.
TEST(Media, NestedBallsAreEnteredAndLeftInTurn) {
  const Shapes media({ball(Vec3(0), 1), ball(Vec3(0), 0.5), ball(Vec3(0), 2)});
  const Walker walker(media, {});
  SolveCounters counters;
  Ray ray;
  ray.origin = {-5, 0.01f, 0.02f}, ray.direction = {1, 0, 0};
  struct Crossing {
    float x;
    uint32_t shape;
    bool is_leaving;
  };
  for (const Crossing& c : {Crossing{-2, 2, false}, {-1, 0, false}, {-0.5f, 1, false}, {0.5f, 1, true}, {1, 0, true}, {2, 2, true}}) {
    Hit hit;
    ASSERT_TRUE(walker.tracer().intersect(ray, counters, hit));
    EXPECT_NEAR(hit.position.x, c.x, 2e-3);
    EXPECT_EQ(hit.shape, c.shape);
    EXPECT_EQ(hit.is_leaving, c.is_leaving);
    EXPECT_EQ(depart(ray, hit, -ray.direction, Side::near).inside.contains(c.shape), c.is_leaving);
    ray = depart(ray, hit, ray.direction, Side::far);
    EXPECT_EQ(ray.inside.contains(c.shape), !c.is_leaving);
  }
  Hit hit;
  EXPECT_FALSE(walker.tracer().intersect(ray, counters, hit));
  EXPECT_TRUE(ray.inside.is_empty());
}

TEST(Media, AShapeIsEnteredOnceWhateverItHolds) {
  ShapeSet set;
  for (uint32_t i = 0; i < 20; ++i) set.add(i / 2);
  for (uint32_t i = 0; i < 10; ++i) EXPECT_EQ(set.contains(i), i < ShapeSet::k_most);
  set.remove(3), set.remove(3), set.remove(99);
  EXPECT_FALSE(set.contains(3));
  for (uint32_t i = 0; i < ShapeSet::k_most; ++i) set.remove(i);
  EXPECT_TRUE(set.is_empty());
}

TEST(Media, Nested) {
  WalkTally met;
  expect_right({ball(Vec3(0), 1), ball(Vec3(0.2f, 0, 0), 0.5), ball(Vec3(0), 2)}, 2000, met);
  EXPECT_GT(met.surfaces, 4000);
  EXPECT_EQ(met.deepest, 3);
}

TEST(Media, Overlapping) {
  WalkTally met;
  for (unsigned trial = 0; trial < 10; ++trial) {
    SCOPED_TRACE(trial);
    Random r(trial);
    std::vector<SampledField> fields;
    for (int i = 0; i < 5; ++i) fields.push_back(field_of(random_cloud(r, 6, trial % 2 ? 0.5 : -1)));
    expect_right(fields, 300, met, trial % 3 ? CellLimits{} : k_small_cells);
  }
  EXPECT_GT(met.surfaces, 2000);
  EXPECT_GE(met.deepest, 2);
}

TEST(Media, TreesOverlapping) {
  WalkTally met;
  for (unsigned trial = 0; trial < 40; ++trial) {
    SCOPED_TRACE(trial);
    Random r(trial);
    std::vector<SampledField> fields(4);
    for (SampledField& field : fields) random_tree(r, 1 + int(trial % 2), field);
    expect_right(fields, 50, met, k_small_cells);
  }
  EXPECT_GT(met.surfaces, 1000);
  EXPECT_GT(met.deepest, 2);
}

// Surfaces that lie in one another, or within the offset of secondary rays: the liquid in a glass.
TEST(Media, Touching) {
  WalkTally met;
  Random r(1);
  const BlobCloud cloud = random_cloud(r, 12, 0.5);
  BlobCloud shifted = cloud;
  for (Blob& b : shifted) b.centre.x += 1e-4f;
  for (const CellLimits& limits : {CellLimits{}, k_small_cells})
    expect_right({field_of(cloud), field_of(cloud), field_of(shifted)}, 3000, met, limits);
  expect_right({ball(Vec3(0), 1), ball(Vec3(0), 1), ball(Vec3(2, 0, 0), 1)}, 3000, met);
  EXPECT_GT(met.surfaces, 2000);
}

} // namespace
} // namespace kelpie
