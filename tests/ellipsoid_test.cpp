// Blobs that are ellipsoids: their numbers, their files, and what a liquid makes of them. (Rays: tracer_test.cpp and motion_test.cpp.)
#include <cmath>
#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

#include "base/error.h"
#include "field/clouds/cloud_file.h"
#include "morph/liquid/interpolate.h"
#include "morph/liquid/volume.h"
#include "tests/support/random_scene.h"

namespace kelpie {
namespace {

BlobCloud ellipsoids() {
  BlobCloud cloud = ellipsoid_cloud(Falloff::quartic);
  std::erase_if(cloud, [](const Blob& b) { return is_round(b); });
  return cloud;
}

double field(const BlobCloud& cloud, const Vec3d& p) {
  double sum = 0;
  for (const Blob& b : cloud) {
    const Vec3d in_ball = to_unit_ball(b).matrix() * (p - Vec3d(b.centre));
    sum += b.weight * falloff(b.falloff, std::min(1.0, glm::dot(in_ball, in_ball)));
  }
  return sum;
}

double largest(const Mat3d& m) { return std::max({glm::length(m[0]), glm::length(m[1]), glm::length(m[2])}); }

TEST(Ellipsoid, IsWhatItsMatrixSays) {
  Random r(1);
  for (const Blob& b : ellipsoids()) {
    EXPECT_NEAR(glm::determinant(b.shape.matrix()), 1, 1e-4);
    const HalfAxes axes = half_axes(b);
    const Box3 box = support(b);
    float longest = 0, shortest = 1e9f;
    for (int i = 0; i < 400; ++i) {
      const Vec3d way = r.direction() * reach_towards(b, r.direction()) * 0.999;
      const Vec3d border = way / std::sqrt(squared_place(b, way)); // where the influence ends
      EXPECT_NEAR(squared_place(b, border), 1, 1e-6);
      EXPECT_TRUE(box.contains(b.centre + Vec3(0.9999 * border)));
      longest = std::max(longest, float(glm::length(border))), shortest = std::min(shortest, float(glm::length(border)));
    }
    EXPECT_LE(longest, axes.longest * 1.0001f);
    EXPECT_GE(shortest, axes.shortest * 0.9999f);
    EXPECT_LE(box.extent().x, 2.001f * axes.longest);
  }
}

TEST(Ellipsoid, MayBeGivenByAnyMatrix) {
  Random r(2);
  for (int trial = 0; trial < 200; ++trial) {
    Mat3d m;
    for (int i = 0; i < 3; ++i) m[i] = r.direction() * r.log_uniform(0.2, 20);
    Blob b{Vec3(1, 2, 3), 1, 2, Falloff::quartic};
    if (!set_ellipsoid(b, m)) continue;
    const Vec3d d = r.direction();
    const double place2 = glm::dot(m * d, m * d);
    EXPECT_NEAR(squared_place(b, d) / place2, 1, 1e-4);
    const Affine map{m * glm::mat3_cast(glm::angleAxis(1.0, r.direction())), Vec3d(0.5)};
    if (const std::optional<Blob> seen = mapped(b, map)) {
      EXPECT_NEAR(squared_place(*seen, map.linear * d) / place2, 1, 2e-3);
    }
  }
  Blob b;
  EXPECT_FALSE(set_ellipsoid(b, Mat3d(0.0)));
  EXPECT_FALSE(set_ellipsoid(b, Mat3d{{1, 0, 0}, {0, 1, 0}, {0, 0, 1e-4}})) << "too flat";
  EXPECT_FALSE(set_ellipsoid(b, Mat3d(std::nan(""))));
  EXPECT_TRUE(is_round(b)) << "it stays as it was";
}

TEST(Ellipsoid, BetweenTwoHasTheSameVolume) {
  const BlobCloud cloud = ellipsoids();
  for (size_t i = 1; i < cloud.size(); ++i) {
    EXPECT_EQ(between(cloud[i].shape, cloud[i - 1].shape, 0), cloud[i].shape);
    EXPECT_EQ(between(cloud[i].shape, cloud[i - 1].shape, 1), cloud[i - 1].shape);
    EXPECT_NEAR(glm::determinant(between(cloud[i].shape, cloud[i - 1].shape, 0.3f).matrix()), 1, 1e-4);
  }
}

class CloudFile : public testing::Test {
protected:
  ~CloudFile() override { std::filesystem::remove(path_); }
  std::string message_of(const std::string& text) {
    std::ofstream(path_) << text;
    try {
      read_blob_cloud(path_);
    } catch (const Error& e) {
      EXPECT_EQ(e.status, ExitStatus::bad_data);
      return e.what();
    }
    return "";
  }
  std::string path_ = testing::TempDir() + "/kelpie_" + testing::UnitTest::GetInstance()->current_test_info()->name() + ".ply";
};

TEST_F(CloudFile, KeepsEllipsoids) {
  const BlobCloud cloud = ellipsoid_cloud(Falloff::quartic); // some are round
  write_blob_cloud(path_, cloud);
  const BlobCloud back = read_blob_cloud(path_);
  ASSERT_EQ(back.size(), cloud.size());
  for (size_t i = 0; i < cloud.size(); ++i) {
    EXPECT_EQ(back[i].centre, cloud[i].centre);
    EXPECT_EQ(back[i].weight, cloud[i].weight);
    EXPECT_NEAR(back[i].radius / cloud[i].radius, 1, 1e-5);
    const Mat3d was = to_unit_ball(cloud[i]).matrix();
    EXPECT_LT(largest(to_unit_ball(back[i]).matrix() - was), 1e-5 * largest(was));
  }
}

TEST_F(CloudFile, RefusesWhatIsNoEllipsoid) {
  std::string head = "ply\nformat ascii 1.0\nelement vertex 1\n";
  for (const char* name : {"x", "y", "z", "radius", "weight", "ax", "ay", "az", "bx", "by", "bz", "cx", "cy"})
    head += std::string("property float ") + name + "\n";
  const std::string blob = "0 0 0 1 1  ";
  EXPECT_NE(message_of(head + "end_header\n" + blob + "1 0 0 0 1 0 0 0\n").find("no property \"cz\""), std::string::npos);
  head += "property float cz\nend_header\n";
  EXPECT_EQ(message_of(head + blob + "0 0 2 0 1 0 1 0 0\n"), "") << "any matrix with an inverse";
  EXPECT_EQ(message_of(head + "0 0 0 0 1  1 0 0 0 1 0 0 0 1\n"), "") << "the radius counts for nothing";
  EXPECT_NE(message_of(head + blob + "1 0 0 0 1 0 1 1 0\n").find("blob 0: ax … cz make no ellipsoid"), std::string::npos);
  EXPECT_NE(message_of(head + blob + "1 0 0 0 nan 0 0 0 1\n").find("by is not a finite number"), std::string::npos);
}

TEST(EllipsoidVolume, IsThatOfTheBallTimesTheAxes) {
  Blob b{Vec3(0.2f, 0.1f, 0), 1, 2, Falloff::quartic};
  const Mat3d turn = glm::mat3_cast(glm::angleAxis(0.7, glm::normalize(Vec3d(1, 2, 3))));
  ASSERT_TRUE(set_ellipsoid(b, Mat3d{{1, 0, 0}, {0, 2, 0}, {0, 0, 4}} * turn));
  const double level = std::sqrt(1 - std::sqrt(0.5)), ball = 4.0 / 3 * 3.14159265358979 * level * level * level;
  const CloudExtent extent = extent_of({b});
  EXPECT_NEAR(extent.volume, ball / 8, 0.01 * ball / 8);
}

TEST(EllipsoidLiquid, IsExactlyItsEndsAndContinuous) {
  BlobCloud from = ellipsoids(), to = from;
  std::erase_if(from, [](const Blob& b) { return b.weight < 0; });
  from.resize(40), to.resize(60);
  std::erase_if(to, [](const Blob& b) { return b.weight < 0; });
  for (Blob& b : to) b.centre = b.centre * 0.7f + Vec3(0.2f);
  for (const Correspondence how : {Correspondence::flow, Correspondence::transport, Correspondence::cellular}) {
    const LiquidMorph morph(from, to, how, VolumeRule::linear);
    const auto cloud_at = [&](float u) {
      BlobCloud cloud;
      morph.append_parts(u, cloud);
      return cloud;
    };
    Random r(3);
    double farthest_step = 0, most = 0;
    for (int i = 0; i < 60; ++i) {
      const Vec3d p = r.in(Box3d{Vec3d(-1), Vec3d(1)});
      EXPECT_NEAR(field(cloud_at(0), p), field(from, p), 1e-4);
      EXPECT_NEAR(field(cloud_at(1), p), field(to, p), 1e-4);
      for (int j = 0; j < 50; ++j) {
        const double f = field(cloud_at(float(j) / 50), p);
        const double g = field(cloud_at((float(j) + 0.02f) / 50), p);
        farthest_step = std::max(farthest_step, std::abs(f - g)), most = std::max(most, f);
      }
    }
    EXPECT_LT(farthest_step, 0.03 * most);
    EXPECT_FALSE(is_round(cloud_at(0)[0]));
  }
}

// On its way liquid is round: plates would fly through the air.
TEST(EllipsoidLiquid, FlowsInDrops) {
  BlobCloud from = ellipsoids(), to;
  std::erase_if(from, [](const Blob& b) { return b.weight < 0; });
  for (Blob b : from) b.centre += Vec3(1, 0, 0), to.push_back(b);
  const LiquidMorph morph(from, to, Correspondence::flow, VolumeRule::free);
  BlobCloud middle;
  morph.append_blobs(0.5f, middle);
  for (const Blob& b : middle) EXPECT_LT(half_axes(b).longest, 1.05f * half_axes(b).shortest);
}

} // namespace
} // namespace kelpie
