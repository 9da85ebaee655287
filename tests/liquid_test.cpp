#include "morph/liquid/fit.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "morph/liquid/body_graph.h"
#include "morph/liquid/flow_path.h"
#include "morph/liquid/interpolate.h"
#include "morph/liquid/local_balance.h"
#include "morph/liquid/match.h"
#include "morph/liquid/spread.h"
#include "morph/liquid/surface_samples.h"
#include "morph/liquid/volume.h"
#include "tests/support/liquid_clouds.h"

namespace kelpie {
namespace {

Mesh torus(int around, int along, double tube) {
  Mesh m;
  for (int i = 0; i < around; ++i)
    for (int j = 0; j < along; ++j) {
      const double a = 2 * k_pi * i / around, b = 2 * k_pi * j / along, r = 1 + tube * std::cos(b);
      m.positions.push_back({r * std::cos(a), tube * std::sin(b), r * std::sin(a)});
      const auto at = [&](int x, int y) { return static_cast<uint32_t>((x % around) * along + y % along); };
      m.triangles.push_back({at(i, j), at(i, j + 1), at(i + 1, j)});
      m.triangles.push_back({at(i + 1, j), at(i, j + 1), at(i + 1, j + 1)});
    }
  return m;
}

TEST(Samples, AreSpreadAndTheSameEveryTime) {
  const Mesh mesh = torus(48, 24, 0.4);
  const auto a = spread_samples(mesh, 1000, 1), b = spread_samples(mesh, 1000, 1), other = spread_samples(mesh, 1000, 2);
  ASSERT_EQ(a.size(), b.size());
  EXPECT_GT(a.size(), 900u);
  EXPECT_LE(a.size(), 1000u);
  EXPECT_EQ(a[17].position, b[17].position);
  EXPECT_NE(a[17].position, other[17].position);
  double nearest = 1e9;
  for (size_t i = 0; i < a.size(); ++i)
    for (size_t j = 0; j < i; ++j) nearest = std::min(nearest, glm::length(a[i].position - a[j].position));
  EXPECT_GT(nearest, 0.69 * std::sqrt(2 * surface_area(mesh) / (std::sqrt(3.0) * 1000)));
}

FitOptions round_blobs(size_t count) {
  FitOptions o;
  o.blobs = count, o.may_use_fewer = false, o.shape = FitShape::round;
  return o;
}

TEST(Fit, TorusIsCloseEverywhereAndNothingSticksOut) {
  const FitResult r = fit_blobs(torus(64, 32, 0.35), round_blobs(120), "torus");
  EXPECT_GT(r.blobs.size(), 90u);
  EXPECT_LE(r.blobs.size(), 120u);
  EXPECT_LT(r.rms, 0.001);
  EXPECT_LT(r.max, 0.005);
  EXPECT_EQ(r.lost, 0);
  EXPECT_EQ(r.spurs, 0);
  for (const Blob& b : r.blobs) {
    EXPECT_TRUE(is_round(b));
    EXPECT_GT(b.weight, 0);
    EXPECT_LT(b.weight, 17);
  }
}

TEST(Fit, UsesFewerWhereTheyAreAsGood) {
  const FitResult r = fit_blobs(torus(64, 32, 0.35), {400}, "torus");
  EXPECT_LT(r.blobs.size(), 200u);
  EXPECT_LT(r.rms, 0.0005);
}

TEST(Fit, IsTheSameEveryTimeAndInTheFilesCoordinates) {
  Mesh mesh = torus(40, 20, 0.35);
  const FitResult a = fit_blobs(mesh, round_blobs(60), "torus"), b = fit_blobs(mesh, round_blobs(60), "torus");
  EXPECT_TRUE(same(a.blobs, b.blobs));
  mesh.origin = {100, 0, 0};
  const FitResult moved = fit_blobs(mesh, round_blobs(60), "torus");
  EXPECT_NEAR(moved.blobs[0].centre.x, a.blobs[0].centre.x + 100, 1e-4);
}

/// 2 by `thickness` by 2.
Mesh plate(double thickness) {
  Mesh m;
  for (int i = 0; i < 8; ++i) m.positions.push_back({i & 4 ? 1 : -1, (i & 2 ? 0.5 : -0.5) * thickness, i & 1 ? 1 : -1});
  const uint32_t sides[6][4] = {{0, 1, 3, 2}, {4, 6, 7, 5}, {0, 4, 5, 1}, {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 5, 7, 3}};
  for (const auto& s : sides) m.triangles.push_back({s[0], s[1], s[2]}), m.triangles.push_back({s[0], s[2], s[3]});
  return m;
}

// Samples are farther apart than it is thick, and thousands lie in one plane.
TEST(Fit, ThinPlatesEndSoon) {
  std::vector<double> done;
  FitOptions options;
  options.progress = [&](double share) { done.push_back(share); };
  const FitResult r = fit_blobs(plate(0.01), options, "plate");
  EXPECT_LT(r.sphere_tree_s + r.fit_s, 20);
  EXPECT_EQ(r.lost, 0);
  EXPECT_GE(done.size(), 3u);
  EXPECT_TRUE(std::is_sorted(done.begin(), done.end()));
  EXPECT_GT(done.front(), 0);
  EXPECT_LE(done.back(), 1);
  try {
    fit_blobs(plate(0.01), round_blobs(50), "plate");
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.status, ExitStatus::bad_data);
    EXPECT_NE(std::string(e.what()).find("plate: the mesh is too thin for 50 blobs: "), std::string::npos) << e.what();
  }
  try {
    fit_blobs(plate(0.001), {50}, "foil");
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.status, ExitStatus::bad_data);
    EXPECT_NE(std::string(e.what()).find("foil: the mesh has no inside"), std::string::npos) << e.what();
  }
  EXPECT_LT(fit_blobs(plate(0.5), {300}, "block").rms, 0.004);
}

TEST(Fit, RefusesWhatEnclosesNothing) {
  Mesh flat;
  flat.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  flat.triangles = {{0, 1, 2}};
  try {
    fit_blobs(flat, {}, "flat.obj");
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.status, ExitStatus::bad_data);
  }
}

TEST(Match, EverybodyHasPartnersAndSharesSumToOne) {
  const BlobCloud a = row(), b = ring();
  for (const auto& links : {match_cellular(a, b), match_transport(a, b), match_transport(a, b, BodyGraph(a, b))}) {
    std::vector<double> from(a.size(), 0), to(b.size(), 0);
    for (const Link& l : links) from[l.from] += l.from_share, to[l.to] += l.to_share;
    for (const double s : from) EXPECT_NEAR(s, 1, 1e-5);
    for (const double s : to) EXPECT_NEAR(s, 1, 1e-5);
  }
}

/// A bent arm of balls that touch: from the shoulder at the origin up, then right.
BlobCloud arm() {
  BlobCloud c;
  for (int i = 0; i < 19; ++i) c.push_back({Vec3(0, 0.1f * float(i), 0), 0.3f, 1.3f, Falloff::quartic});
  for (int i = 1; i < 19; ++i) c.push_back({Vec3(0.1f * float(i), 1.8f, 0), 0.3f, 1.3f, Falloff::quartic});
  return c;
}

TEST(BodyGraph, WaysLeadThroughTheBodies) {
  const BlobCloud from{{Vec3(0), 0.3f, 2.f, Falloff::quartic}}, to = arm();
  const BodyGraph bodies(from, to);
  EXPECT_NEAR(bodies.length(0, 36), 3.6, 0.2); // up and right, but for the elbow's inside
  const std::vector<Vec3d> way = bodies.way(0, 36);
  EXPECT_EQ(way.front(), Vec3d(0));
  EXPECT_EQ(way.back(), Vec3d(to[36].centre));
  for (const Vec3d& p : way) EXPECT_TRUE(std::abs(p.x) < 1e-6 || std::abs(p.y - 1.8) < 1e-6) << p.x << " " << p.y;
}

TEST(BodyGraph, LeapsWhereItIsNearest) {
  BlobCloud to = arm();
  for (size_t i = 19; i < to.size(); ++i) to[i].centre.x += 0.5f; // the elbow is torn
  const BodyGraph bodies({{Vec3(0), 0.3f, 2.f, Falloff::quartic}}, to);
  EXPECT_GT(bodies.length(0, 36), 3.9 + (BodyGraph::k_air - 1) * 0.2);
  const std::vector<Vec3d> way = bodies.way(0, 36);
  for (const Vec3d& p : way) EXPECT_TRUE(std::abs(p.x) < 1e-6 || std::abs(p.y - 1.8) < 1e-6);
}

TEST(BodyGraph, BodiesApartAreLaidUponEachOther) {
  BlobCloud from = arm(), to = arm();
  for (Blob& b : to) b.centre += Vec3(20, 0, 0);
  const BodyGraph bodies(from, to);
  for (size_t i = 0; i < from.size(); ++i) {
    EXPECT_NEAR(bodies.length(i, i), 0, 1e-5);
    EXPECT_NEAR(bodies.way(i, i).back().x, to[i].centre.x, 1e-5);
  }
}

TEST(FlowPath, IsSmoothEvenAndExactAtItsEnds) {
  const std::vector<Vec3d> way{{0, 0, 0}, {0, 1, 0}, {0, 2, 0}, {0.1, 2, 0}, {2, 2, 0}};
  const Spline<Vec3d> path = flow_path(way);
  EXPECT_EQ(path(0), way.front());
  EXPECT_LT(glm::distance(path(1), way.back()), 1e-12);
  double least = 1e9, most = 0, turn = 0;
  for (int i = 0; i < 100; ++i) {
    const double step = glm::distance(path(i / 100.0), path((i + 1) / 100.0));
    least = std::min(least, step), most = std::max(most, step);
    if (i > 0) {
      const Vec3d a = path(i / 100.0) - path((i - 1) / 100.0), b = path((i + 1) / 100.0) - path(i / 100.0);
      turn = std::max(turn, std::acos(std::clamp(glm::dot(glm::normalize(a), glm::normalize(b)), -1.0, 1.0)));
    }
  }
  EXPECT_LT(most, 1.5 * least);
  EXPECT_LT(turn, 0.3); // of a right angle
}

// Ten balls in one place are ten times too much; one that is alone is as it should be.
/// Parts along a ring, each wanting the density that they have where they are even.
std::vector<LiquidPart> ring_of_parts(double clumping) {
  constexpr int k_count = 200;
  const auto at = [](double by) {
    std::vector<LiquidPart> parts;
    for (int i = 0; i < k_count; ++i) {
      const double a = 2 * k_pi * i / k_count, turned = a + by * std::sin(8 * a) / 8;
      parts.push_back({Vec3d(std::cos(turned), 0, std::sin(turned)), 0.4, 0.01});
    }
    return parts;
  };
  std::vector<LiquidPart> parts = at(clumping);
  const std::vector<double> even = densities(at(0));
  for (size_t i = 0; i < parts.size(); ++i) parts[i].wanted = even[i];
  return parts;
}

TEST(Spread, ClosesTheGapsThatLiquidLeft) {
  // The least potential on the ring, as a share of the largest.
  const auto evenness = [](std::span<const Vec3d> places) {
    double least = 1e9, most = 0;
    for (int i = 0; i < 256; ++i) {
      const double a = 2 * k_pi * i / 256;
      double sum = 0;
      for (const Vec3d& p : places) {
        const Vec3d d = (p - Vec3d(std::cos(a), 0, std::sin(a))) / 0.4;
        sum += falloff(Falloff::quartic, glm::dot(d, d));
      }
      least = std::min(least, sum), most = std::max(most, sum);
    }
    return least / most;
  };
  const auto places = [](std::span<const LiquidPart> parts) {
    std::vector<Vec3d> all;
    for (const LiquidPart& part : parts) all.push_back(part.centre);
    return all;
  };
  const std::vector<LiquidPart> clumped = ring_of_parts(-0.95);
  const std::vector<Vec3d> evened = spread(clumped);
  EXPECT_GT(evenness(evened), 1.3 * evenness(places(clumped))) << evenness(places(clumped));
  for (const Vec3d& p : evened) EXPECT_NEAR(glm::length(p), 1, 0.05) << "along the ring";
  EXPECT_EQ(spread(clumped), evened) << "the same every time";
  const std::vector<LiquidPart> even = ring_of_parts(0);
  const std::vector<Vec3d> stayed = spread(even);
  for (size_t i = 0; i < even.size(); ++i) EXPECT_LT(glm::distance(stayed[i], even[i].centre), 0.02);
}

TEST(LocalBalance, TakesAwayWhatPilesUp) {
  BlobCloud c(10, {Vec3(0), 1.f, 2.f, Falloff::quartic});
  c.push_back({Vec3(5, 0, 0), 1.f, 2.f, Falloff::quartic});
  EXPECT_NEAR(potentials_at_centres(c)[3], 20, 1e-5);
  const std::vector<double> factors = balancing_factors(c, std::vector<double>(11, 2.0));
  for (size_t i = 0; i < 10; ++i) EXPECT_NEAR(factors[i], 0.1, 0.01);
  EXPECT_EQ(factors[10], 1);
  EXPECT_EQ(balancing_factors(c, std::vector<double>(11, 100.0))[10], k_most_given);
}

TEST(Match, AMovedAndScaledCopyIsMatchedToItself) {
  const BlobCloud a = ring();
  BlobCloud b = a;
  for (Blob& x : b) x.centre = 3.f * x.centre + Vec3(1, 2, 3), x.radius *= 3;
  const auto links = match_cellular(a, b);
  EXPECT_GE(links.size(), a.size());
  for (const Link& l : links) EXPECT_EQ(l.from, l.to);
}

TEST(Morph, EndsAreExact) {
  const BlobCloud a = row(), b = ring();
  for (const Correspondence how : k_all)
    for (const VolumeRule rule : {VolumeRule::free, VolumeRule::linear}) {
      const LiquidMorph morph(a, b, how, rule);
      EXPECT_TRUE(same(at(morph, 0), a));
      EXPECT_TRUE(same(at(morph, 1), b));
    }
}

/// The split parts add up to the whole blobs: no jump when the morph sets out or arrives.
TEST(Morph, IsContinuousAtTheEnds) {
  const BlobCloud a = row(), b = ring();
  for (const Correspondence how : k_all) {
    const LiquidMorph morph(a, b, how, VolumeRule::linear);
    const BlobCloud first = at(morph, 1e-5f), last = at(morph, 1 - 1e-5f);
    for (int i = 0; i < 200; ++i) {
      const double u = i / 199.0;
      const Vec3d p(-0.5 + 3 * u, 0.2 * std::sin(20 * u), 0.1 * std::cos(30 * u)), q(4 + 2 * u, std::sin(20 * u), 0.1);
      EXPECT_NEAR(field(first, p), field(a, p), 0.02);
      EXPECT_NEAR(field(last, q), field(b, q), 0.02);
    }
  }
}

TEST(Morph, VolumeIsLinear) {
  const BlobCloud a = row(), b = ring();
  Box3 box;
  for (const Blob& x : a) box.extend(support(x));
  for (const Blob& x : b) box.extend(support(x));
  const VolumeGrid grid(box, 500'000);
  const double first = grid.volume(a), last = grid.volume(b);
  for (const Correspondence how : k_all) {
    const LiquidMorph morph(a, b, how, VolumeRule::linear);
    for (int i = 0; i <= 20; ++i) {
      const float u = static_cast<float>(i) / 20;
      EXPECT_NEAR(grid.volume(at(morph, u)), first + (last - first) * u, 0.05 * std::max(first, last)) << "progress " << u;
    }
  }
}

/// How many pieces {f > 1} has, on a grid of points.
int pieces(const BlobCloud& cloud, const Box3& box, int n) {
  std::vector<char> inside;
  for (int z = 0; z < n; ++z)
    for (int y = 0; y < n; ++y)
      for (int x = 0; x < n; ++x) inside.push_back(field(cloud, Vec3d(box.lower + box.extent() * Vec3(x, y, z) / float(n - 1))) > 1);
  int count = 0;
  std::vector<int> stack;
  for (int start = 0; start < n * n * n; ++start) {
    if (!inside[size_t(start)]) continue;
    ++count, stack.push_back(start), inside[size_t(start)] = 0;
    while (!stack.empty()) {
      const int at = stack.back(), place[] = {at % n, at / n % n, at / n / n}, stride[] = {1, n, n * n};
      stack.pop_back();
      for (int axis = 0; axis < 3; ++axis)
        for (const int side : {-1, 1}) {
          if (place[axis] + side < 0 || place[axis] + side >= n || !inside[size_t(at + side * stride[axis])]) continue;
          inside[size_t(at + side * stride[axis])] = 0, stack.push_back(at + side * stride[axis]);
        }
    }
  }
  return count;
}

// An arm that points up and right becomes one that points up and left: it is drawn in and out, and nothing leaps through the air.
TEST(Morph, LimbsAreDrawnInAndOut) {
  const BlobCloud a = arm();
  BlobCloud b = a;
  for (Blob& x : b) x.centre.x = -x.centre.x;
  Box3 box;
  for (const BlobCloud& cloud : {a, b})
    for (const Blob& x : cloud) box.extend(support(x));
  const LiquidMorph flow(a, b, Correspondence::flow, VolumeRule::linear);
  for (int i = 0; i <= 10; ++i) EXPECT_EQ(pieces(at(flow, float(i) / 10), box, 48), 1) << "progress " << i / 10.0;
}

// Nothing jumps where it begins to flow, and its volume is that of the ends.
TEST(Morph, MoltenEndsAreAsSmoothAsBetween) {
  const BlobCloud a = arm();
  BlobCloud b = a;
  for (Blob& x : b) x.centre.x = -x.centre.x;
  const LiquidMorph molten(a, b, Correspondence::flow, VolumeRule::linear, LiquidEnds::molten);
  float least = 1e9f;
  for (const Blob& x : at(molten, 0)) least = std::min(least, x.radius);
  EXPECT_GT(least, 1.05f * a[0].radius);
  EXPECT_NEAR(extent_of(at(molten, 0)).volume, extent_of(a).volume, 0.05 * extent_of(a).volume);
  EXPECT_NEAR(extent_of(at(molten, 1)).volume, extent_of(b).volume, 0.05 * extent_of(b).volume);
  const BlobCloud first = at(molten, 0), next = at(molten, 1e-4f);
  for (int i = 0; i < 100; ++i) {
    const Vec3d p(0.01 * i, 1.7, 0.1);
    EXPECT_NEAR(field(first, p), field(next, p), 0.01);
  }
}

TEST(Morph, DoesNotDependOnTheNumberOfThreads) {
  const auto with_threads = [](size_t n) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, n);
    return at(LiquidMorph(row(), ring(), Correspondence::flow, VolumeRule::linear), 0.37f);
  };
  EXPECT_TRUE(same(with_threads(1), with_threads(4)));
}

TEST(Morph, OneBlobBecomesAnother) {
  const BlobCloud a{{Vec3(0), 1.f, 4.f, Falloff::quartic}}, b{{Vec3(2, 0, 0), 2.f, 4.f, Falloff::quartic}};
  for (const Correspondence how : k_all) {
    const BlobCloud half = at(LiquidMorph(a, b, how, VolumeRule::linear), 0.5f);
    ASSERT_EQ(half.size(), 1u);
    EXPECT_NEAR(half[0].centre.x, 1, 1e-5);
    EXPECT_GT(half[0].radius, 1.2f);
    EXPECT_LT(half[0].radius, 2.f);
  }
}

TEST(Volume, OfASphereIsRight) {
  // The surface of a lone blob of weight 4 lies at R sqrt(1/2).
  const CloudExtent e = extent_of({{Vec3(1, 2, 3), 2.f, 4.f, Falloff::quartic}});
  EXPECT_NEAR(e.volume, 4.0 / 3 * k_pi * std::pow(2.0, 1.5), 0.01 * e.volume);
  EXPECT_NEAR(e.box.lower.x, 1 - std::sqrt(2.f), 0.05);
  EXPECT_NEAR(e.box.upper.z, 3 + std::sqrt(2.f), 0.05);
  EXPECT_GT(e.bulk.diagonal(), 0.8f * e.box.diagonal());
}

// What a speck does to a box does not tell how large nearly all of it is.
TEST(Volume, OfNearlyAllIsWhereItIs) {
  const CloudExtent e = extent_of({{Vec3(0), 1.f, 4.f, Falloff::quartic}, {Vec3(30, 0, 0), 0.2f, 4.f, Falloff::quartic}});
  EXPECT_GT(e.box.upper.x, 30);
  EXPECT_LT(e.bulk.upper.x, 1.5f);
  EXPECT_GT(e.bulk.upper.x, 0.3f);
}

} // namespace
} // namespace kelpie
