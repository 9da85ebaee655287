#include "morph/liquid/fit.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "morph/liquid/interpolate.h"
#include "morph/liquid/match.h"
#include "morph/liquid/surface_samples.h"
#include "morph/liquid/volume.h"

namespace kelpie {
namespace {

constexpr double k_pi = 3.14159265358979323846;
constexpr Correspondence k_all[] = {Correspondence::transport, Correspondence::cellular};

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

double field(const BlobCloud& cloud, const Vec3d& p) {
  double sum = 0;
  for (const Blob& b : cloud) {
    const Vec3d d = p - Vec3d(b.centre);
    sum += b.weight * falloff(b.falloff, glm::dot(d, d) / (double(b.radius) * b.radius));
  }
  return sum;
}

/// Blobs in a row, and a ring of smaller ones: different counts, sizes and places.
BlobCloud row() {
  BlobCloud c;
  for (int i = 0; i < 7; ++i) c.push_back({Vec3(0.3f * i, 0, 0), 0.5f, 2.f, Falloff::quartic});
  return c;
}
BlobCloud ring() {
  BlobCloud c;
  for (int i = 0; i < 20; ++i) {
    const float a = static_cast<float>(2 * k_pi * i / 20);
    c.push_back({Vec3(5 + std::cos(a), std::sin(a), 0.1f), 0.3f + 0.1f * std::cos(a), 1.5f, Falloff::quartic});
  }
  return c;
}

BlobCloud at(const LiquidMorph& morph, float progress) {
  BlobCloud c;
  morph.append_blobs(progress, c);
  return c;
}

bool same(const BlobCloud& a, const BlobCloud& b) {
  if (a.size() != b.size()) return false;
  for (size_t i = 0; i < a.size(); ++i)
    if (a[i].centre != b[i].centre || a[i].radius != b[i].radius || a[i].weight != b[i].weight) return false;
  return true;
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

TEST(Fit, TorusIsCloseEverywhereAndNothingSticksOut) {
  const FitResult r = fit_blobs(torus(64, 32, 0.35), {120, false}, "torus");
  EXPECT_GT(r.blobs.size(), 90u);
  EXPECT_LE(r.blobs.size(), 120u);
  EXPECT_LT(r.rms, 0.001);
  EXPECT_LT(r.max, 0.005);
  EXPECT_EQ(r.lost, 0);
  EXPECT_EQ(r.spurs, 0);
  for (const Blob& b : r.blobs) {
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
  const FitResult a = fit_blobs(mesh, {60, false}, "torus"), b = fit_blobs(mesh, {60, false}, "torus");
  EXPECT_TRUE(same(a.blobs, b.blobs));
  mesh.origin = {100, 0, 0};
  const FitResult moved = fit_blobs(mesh, {60, false}, "torus");
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
  EXPECT_GT(r.blobs.size(), 400u);
  EXPECT_LT(r.lost, 0.5);
  EXPECT_GE(done.size(), 3u);
  EXPECT_TRUE(std::is_sorted(done.begin(), done.end()));
  EXPECT_GT(done.front(), 0);
  EXPECT_LE(done.back(), 1);
  try {
    fit_blobs(plate(0.01), {50}, "plate");
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.status, ExitStatus::bad_data);
    EXPECT_NE(std::string(e.what()).find("plate: the mesh is too thin for 50 blobs: "), std::string::npos) << e.what();
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
  for (const Correspondence how : k_all) {
    std::vector<double> from(a.size(), 0), to(b.size(), 0);
    for (const Link& l : match_blobs(a, b, how)) from[l.from] += l.from_share, to[l.to] += l.to_share;
    for (const double s : from) EXPECT_NEAR(s, 1, 1e-5);
    for (const double s : to) EXPECT_NEAR(s, 1, 1e-5);
  }
}

TEST(Match, AMovedAndScaledCopyIsMatchedToItself) {
  const BlobCloud a = ring();
  BlobCloud b = a;
  for (Blob& x : b) x.centre = 3.f * x.centre + Vec3(1, 2, 3), x.radius *= 3;
  const auto links = match_blobs(a, b, Correspondence::cellular);
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

TEST(Morph, DoesNotDependOnTheNumberOfThreads) {
  const auto with_threads = [](size_t n) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, n);
    return at(LiquidMorph(row(), ring(), Correspondence::transport, VolumeRule::linear), 0.37f);
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
