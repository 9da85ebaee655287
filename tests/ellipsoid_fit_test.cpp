#include "morph/liquid/fit.h"

#include <cmath>

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "field/clouds/cloud_file.h"

namespace kelpie {
namespace {

constexpr double k_pi = 3.14159265358979323846;

/// A grid of quadrangles, `along` by `around`, that is closed around.
Mesh tube(int along, int around, bool closed_along, const std::function<Vec3d(double, double)>& place) {
  Mesh m;
  for (int i = 0; i < along; ++i)
    for (int j = 0; j < around; ++j) m.positions.push_back(place(i / (along - (closed_along ? 0.0 : 1.0)), 2 * k_pi * j / around));
  const auto at = [&](int i, int j) { return static_cast<uint32_t>((i % along) * around + j % around); };
  for (int i = 0; i + (closed_along ? 0 : 1) < along; ++i)
    for (int j = 0; j < around; ++j) {
      m.triangles.push_back({at(i, j), at(i, j + 1), at(i + 1, j)});
      m.triangles.push_back({at(i + 1, j), at(i, j + 1), at(i + 1, j + 1)});
    }
  return m;
}

Mesh torus() {
  return tube(64, 32, true, [](double a, double b) {
    const double r = 1 + 0.35 * std::cos(b);
    return Vec3d(r * std::cos(2 * k_pi * a), 0.35 * std::sin(b), r * std::sin(2 * k_pi * a));
  });
}

/// Superellipsoids without corners: a rod along x, or a plate across y.
Mesh rounded(const Vec3d& half) {
  return tube(48, 64, false, [=](double a, double b) {
    const double width = std::sin(k_pi * (0.002 + 0.996 * a)), height = std::cos(k_pi * (0.002 + 0.996 * a));
    const auto blunt = [](double x) { return std::copysign(std::pow(std::abs(x), 0.7), x); };
    return half * Vec3d(blunt(height), blunt(width) * blunt(std::sin(b)), blunt(width) * blunt(std::cos(b)));
  });
}

FitOptions options_for(size_t blobs, FitShape shape = FitShape::free) {
  FitOptions o;
  o.blobs = blobs, o.may_use_fewer = false, o.shape = shape;
  return o;
}

void expect_smoother(const Mesh& mesh, size_t blobs, double most_rms, double most_degrees) {
  const FitResult free = fit_blobs(mesh, options_for(blobs), "mesh");
  EXPECT_LE(free.blobs.size(), blobs);
  EXPECT_EQ(free.lost, 0);
  EXPECT_LT(free.rms, most_rms);
  EXPECT_LT(free.normals, most_degrees);
  try {
    const FitResult round = fit_blobs(mesh, options_for(blobs, FitShape::round), "mesh");
    EXPECT_TRUE(round.normals > most_degrees || round.rms > most_rms) << round.normals << " " << round.rms;
  } catch (const Error& e) { // or there are not enough of them
    EXPECT_NE(std::string(e.what()).find("too thin"), std::string::npos) << e.what();
  }
}

TEST(EllipsoidFit, PlatesAreSmooth) { expect_smoother(rounded({1, 0.03, 1}), 150, 0.0015, 6); }
TEST(EllipsoidFit, RodsAreSmooth) { expect_smoother(rounded({1, 0.04, 0.04}), 24, 0.0012, 6); }

TEST(EllipsoidFit, TorusIsSmooth) {
  const FitResult r = fit_blobs(torus(), options_for(120), "torus");
  EXPECT_LT(r.rms, 0.0006);
  EXPECT_LT(r.max, 0.003);
  EXPECT_LT(r.normals, 2.5);
  EXPECT_EQ(r.lost, 0);
  EXPECT_EQ(r.spurs, 0);
  for (const Blob& b : r.blobs) {
    EXPECT_GT(b.weight, 0);
    EXPECT_LT(b.weight, 17);
    EXPECT_LT(half_axes(b).longest, 31 * half_axes(b).shortest);
  }
}

bool same(const BlobCloud& a, const BlobCloud& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const Blob& x, const Blob& y) {
    return x.centre == y.centre && x.radius == y.radius && x.weight == y.weight && x.shape == y.shape;
  });
}

TEST(EllipsoidFit, IsTheSameEveryTimeOnAnyThreadsAndInFiles) {
  const auto with_threads = [](size_t n) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, n);
    return fit_blobs(torus(), options_for(40), "torus").blobs;
  };
  const BlobCloud one = with_threads(1);
  EXPECT_TRUE(same(one, with_threads(4)));
  EXPECT_FALSE(is_round(one[0]));
  const BlobCloud read = parse_blob_cloud(blob_cloud_bytes(one), "torus.ply");
  ASSERT_EQ(read.size(), one.size());
  for (size_t i = 0; i < one.size(); ++i) {
    EXPECT_EQ(read[i].centre, one[i].centre);
    EXPECT_NEAR(read[i].radius, one[i].radius, 1e-5 * one[i].radius);
    EXPECT_NEAR(read[i].shape.xy, one[i].shape.xy, 1e-4);
  }
}

TEST(EllipsoidFit, TakesAsManyAsItsGoalNeedsOrRefuses) {
  FitOptions o;
  o.blobs = 400, o.normals = 2.5, o.error_share = 0.0008;
  const FitResult r = fit_blobs(torus(), o, "torus");
  EXPECT_LE(r.normals, 2.5);
  EXPECT_LE(r.rms, 0.0008);
  EXPECT_LT(r.blobs.size(), 400u);
  o.blobs = 30, o.normals = 0.01;
  try {
    fit_blobs(torus(), o, "torus");
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.status, ExitStatus::bad_data);
    EXPECT_NE(std::string(e.what()).find("torus: 30 blobs are not enough: they are off by "), std::string::npos) << e.what();
  }
}

} // namespace
} // namespace kelpie
