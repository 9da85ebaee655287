// Light that wanders below a surface, against walks by the textbook and against what must come out.
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "base/orthonormal_basis.h"
#include "materials/diffuse.h"
#include "materials/subsurface.h"
#include "materials/surfaces.h"
#include "renderer/integrate/sampler.h"
#include "tests/support/render.h"

namespace kelpie {
namespace {

SurfaceParameters translucent(const Vec3& colour, float radius, float anisotropy = 0) {
  SurfaceParameters s;
  s.subsurface_weight = 1, s.subsurface_color.rgb = colour, s.subsurface_radius = radius, s.specular_weight = 0;
  s.subsurface_scatter_anisotropy = anisotropy;
  return s;
}

/// What comes out of a body z < 0, below a plane, or between two planes.
struct Left {
  Vec3d reflected{0}, transmitted{0};
  double distance = 0; ///< mean of the red light that comes out above, along the plane
  double most = 0;     ///< the largest throughput of a walk
};

Left walks_below_plane(const SubsurfaceMedium& medium, double thickness, uint32_t count) {
  Left left;
  for (uint32_t i = 0; i < count; ++i) {
    Sampler sampler(3, 4, 5, i);
    const Vec3 above = DiffuseLobe::sample(sampler.next_pair());
    SubsurfaceWalk walk(medium, {0, 0, 1}, {above.x, above.y, -above.z});
    Vec3d p(0);
    for (int step = 0; step < 20000; ++step) {
      const float distance = walk.next_distance(sampler.next_pair());
      const Vec3d d(walk.direction());
      const double to_surface = d.z > 0 ? -p.z / d.z : d.z < 0 ? (-thickness - p.z) / d.z : INFINITY;
      if (to_surface <= double(distance)) {
        walk.leave(float(to_surface));
        const Vec3d out(walk.throughput());
        p += to_surface * d;
        (d.z > 0 ? left.reflected : left.transmitted) += out / double(count);
        if (d.z > 0) left.distance += out.x * std::hypot(p.x, p.y) / count;
        left.most = std::max({left.most, out.x, out.y, out.z});
        break;
      }
      p += double(distance) * d;
      const Vec3 u = sampler.next_triple();
      walk.collide(distance, Vec2(u), u.z);
      const float rest = std::max({walk.throughput().x, walk.throughput().y, walk.throughput().z});
      if (rest >= 0.1f) continue;
      if (!(sampler.next() < rest / 0.1f)) break;
      walk.strengthen(0.1f / rest);
    }
  }
  left.distance /= left.reflected.x;
  return left;
}

/// One colour, as light goes: an exponential way, a collision that absorbs or scatters by Henyey and Greenstein.
Left by_the_textbook(double extinction, double albedo, double g, double thickness, int count) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> uniform(0, 1);
  Left left;
  for (int i = 0; i < count; ++i) {
    const double phi = 2 * std::numbers::pi * uniform(random), r2 = uniform(random);
    Vec3d p(0), d(std::sqrt(r2) * std::cos(phi), std::sqrt(r2) * std::sin(phi), -std::sqrt(1 - r2));
    for (;;) {
      const double way = -std::log(1 - uniform(random)) / extinction;
      const double to_surface = d.z > 0 ? -p.z / d.z : d.z < 0 ? (-thickness - p.z) / d.z : INFINITY;
      if (to_surface <= way) {
        p += to_surface * d;
        (d.z > 0 ? left.reflected : left.transmitted).x += 1.0 / count;
        if (d.z > 0) left.distance += std::hypot(p.x, p.y) / count;
        break;
      }
      p += way * d;
      if (uniform(random) >= albedo) break;
      const double a = (1 - g * g) / (1 - g + 2 * g * uniform(random));
      const double cosine = g == 0 ? 1 - 2 * uniform(random) : (1 + g * g - a * a) / (2 * g);
      const Vec3d helper = std::abs(d.x) < 0.5 ? Vec3d(1, 0, 0) : Vec3d(0, 1, 0);
      const Vec3d x = glm::normalize(glm::cross(helper, d)), y = glm::cross(d, x);
      const double turn = 2 * std::numbers::pi * uniform(random), sine = std::sqrt(std::max(0.0, 1 - cosine * cosine));
      d = glm::normalize(cosine * d + sine * std::cos(turn) * x + sine * std::sin(turn) * y);
    }
  }
  left.distance /= left.reflected.x;
  return left;
}

// Guided walks by three channels at once find what plain ones find by one.
TEST(Subsurface, GuidedWalksAreUnbiased) {
  for (const double g : {0.0, 0.6, -0.4})
    for (const double albedo : {0.3, 0.8, 0.99})
      for (const double thickness : {1.0, 5.0}) {
        SCOPED_TRACE(testing::Message() << "g " << g << " albedo " << albedo << " thickness " << thickness);
        SubsurfaceMedium medium;
        medium.extinction = Vec3(2, 1, 4), medium.albedo = Vec3(float(albedo), 0.9f, 0.5f), medium.anisotropy = float(g);
        const Left ours = walks_below_plane(medium, thickness, 60000), theirs = by_the_textbook(2, albedo, g, thickness, 200000);
        EXPECT_NEAR(ours.reflected.x, theirs.reflected.x, 0.006);
        EXPECT_NEAR(ours.transmitted.x, theirs.transmitted.x, 0.006);
        EXPECT_NEAR(ours.distance, theirs.distance, 0.04 * theirs.distance);
        EXPECT_LT(ours.most, 6); // 1.5, where guidance stops, times 2, its share, and what telling channels apart adds
      }
}

// The colour is what comes out of a thick body.
TEST(Subsurface, AThickBodyHasItsColour) {
  for (const float g : {0.f, 0.5f})
    for (const Vec3& colour : {Vec3(0.05f, 0.2f, 0.4f), Vec3(0.6f, 0.8f, 0.95f)}) {
      const Left left = walks_below_plane(SubsurfaceMedium(translucent(colour, 0.1f, g)), 1e4, 40000);
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(left.reflected[c], colour[c], 0.02) << "g " << g << " channel " << c;
    }
}

// --- whole frames ---

/// A ball, a distance field, in an environment that is white all over.
FrameScene ball_in_white(const SurfaceParameters& surface) {
  SdfSphere<SampledMode> ball;
  ball.centre = Vec3(0), ball.sphere_radius = 1;
  FrameScene scene = in_white(ball, surface);
  scene.camera.position = Vec3(0, 0, 5);
  scene.film.resolution = {24, 24}, scene.film.spp = 256, scene.film.bounces = 8;
  return scene;
}

/// Mean over the middle of the ball.
Vec3d middle_of(const FrameScene& scene) {
  const FrameImage image = render(scene, {8, 8, 16, 16}).image;
  Vec3d sum(0);
  for (int c = 0; c < 3; ++c) {
    const FrameChannel* channel = image.find(std::array{"R", "G", "B"}[size_t(c)]);
    for (const float v : channel->pixels) sum[c] += double(v) / double(channel->pixels.size());
  }
  return sum;
}

TEST(Subsurface, WhiteFurnace) {
  SurfaceParameters waxy = translucent(Vec3(1), 0.1f);
  EXPECT_NEAR(middle_of(ball_in_white(waxy)).x, 1, 0.01);
  waxy.specular_weight = 1; // under a varnish
  EXPECT_NEAR(middle_of(ball_in_white(waxy)).x, 1, 0.01);
  waxy.subsurface_weight = 0.5f, waxy.base_color.rgb = Vec3(1), waxy.coat_weight = 1, waxy.coat_darkening = 0;
  EXPECT_NEAR(middle_of(ball_in_white(waxy)).x, 1, 0.01);
}

// It is direct light: no bounce is needed to see it.
TEST(Subsurface, IsSeenWithoutBounces) {
  FrameScene scene = ball_in_white(translucent(Vec3(1), 0.1f));
  scene.film.bounces = 0;
  EXPECT_NEAR(middle_of(scene).x, 1, 0.01);
}

// As light comes out near where it went in, a body that is dense beside its size is a matte one.
TEST(Subsurface, ADenseBodyIsMatte) {
  FrameScene scene = ball_in_white(translucent(Vec3(0.6f, 0.4f, 0.2f), 0.002f));
  scene.lights.clear();
  SunLight<SampledMode> sun;
  sun.direction = Vec3(0.5f, 0.5f, 1), sun.angle = 0;
  scene.lights.emplace_back(sun);
  const Vec3d dense = middle_of(scene);
  Matte<SampledMode> matte;
  matte.colour.rgb = Vec3(0.6f, 0.4f, 0.2f);
  set_surface(scene, 0, matte);
  const Vec3d expected = middle_of(scene);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(dense[c] / expected[c], 1, 0.04); // the inversion is within 0.02 of albedos
}

// Light from behind comes through a thin body, and not through a matte one.
TEST(Subsurface, LightComesThrough) {
  FrameScene scene = ball_in_white(translucent(Vec3(0.9f), 0.5f));
  scene.lights.clear();
  SunLight<SampledMode> sun;
  sun.direction = Vec3(0, 0, -1), sun.angle = 0;
  scene.lights.emplace_back(sun);
  EXPECT_GT(middle_of(scene).x, 0.02);
}

} // namespace
} // namespace kelpie
