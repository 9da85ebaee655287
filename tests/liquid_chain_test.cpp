// Liquids that flow through many clouds in a row.
#include "morph/liquid/chain.h"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/liquid_clouds.h"

namespace kelpie {
namespace {

/// Some blobs of all falloffs.
BlobCloud mixture(float x) {
  BlobCloud c;
  const Falloff all[] = {Falloff::quartic, Falloff::cubic, Falloff::wyvill};
  for (int i = 0; i < 9; ++i)
    c.push_back({Vec3(x + 0.2f * std::sin(3.f * i), 0.25f * i, 0.2f * std::cos(5.f * i)), 0.4f + 0.03f * i, 2.f, all[i % 3]});
  return c;
}

BlobCloud at(const LiquidChain& chain, float progress) {
  BlobCloud c;
  chain.append_blobs(progress, c);
  return c;
}

LiquidChain chain_of(const std::vector<BlobCloud>& clouds, Correspondence how, LiquidEnds ends = LiquidEnds::exact) {
  std::vector<const BlobCloud*> row;
  for (const BlobCloud& cloud : clouds) row.push_back(&cloud);
  return {row, how, VolumeRule::linear, ends};
}

/// How far two fields differ near the clouds of these tests.
double difference(const BlobCloud& a, const BlobCloud& b) {
  double most = 0;
  for (int i = 0; i < 300; ++i) {
    const Vec3d p(-0.5 + 7 * i / 299.0, std::sin(1.7 * i), 0.3 * std::cos(2.3 * i));
    most = std::max(most, std::abs(field(a, p) - field(b, p)));
  }
  return most;
}

TEST(Chain, IsExactAtEveryCloud) {
  for (const Correspondence how : k_all)
    for (const size_t count : {2, 3, 4, 7, 11}) {
      std::vector<BlobCloud> clouds;
      for (size_t i = 0; i < count; ++i) clouds.push_back(i % 3 == 0 ? row() : i % 3 == 1 ? ring() : mixture(3));
      const LiquidChain chain = chain_of(clouds, how);
      for (size_t i = 0; i < count; ++i) EXPECT_TRUE(same(at(chain, float(i) / float(count - 1)), clouds[i])) << i << " of " << count;
    }
}

TEST(Chain, OfTwoIsAMorph) {
  const LiquidChain chain = chain_of({row(), ring()}, Correspondence::flow);
  const LiquidMorph morph(row(), ring(), Correspondence::flow, VolumeRule::linear);
  for (const float u : {0.f, 0.3f, 1.f}) EXPECT_TRUE(same(at(chain, u), at(morph, u)));
}

// Only the first and the last one melt.
TEST(Chain, IsMoltenAtItsEndsOnly) {
  const LiquidChain chain = chain_of({row(), ring(), mixture(3)}, Correspondence::flow, LiquidEnds::molten);
  EXPECT_TRUE(same(at(chain, 0.5f), ring()));
  EXPECT_GT(difference(at(chain, 0), row()), 0.01);
  EXPECT_LT(difference(at(chain, 0), at(chain, 1e-4f)), 0.02);
  EXPECT_GT(difference(at(chain, 1), mixture(3)), 0.01);
  for (const float u : {0.5f - 1e-5f, 0.5f + 1e-5f}) EXPECT_LT(difference(at(chain, u), ring()), 0.02);
}

/// Moments that are compiled together have the same parts, and at each the field is what it is by itself: within a passage, on both sides
/// of an inner end and on it, and with several ends between them.
TEST(Chain, PartsAreTheSameAtAllMoments) {
  const std::vector<BlobCloud> clouds{row(), mixture(2), ring(), mixture(4), row()};
  for (const Correspondence how : k_all) {
    const LiquidChain chain = chain_of(clouds, how);
    for (const std::vector<float>& moments : std::vector<std::vector<float>>{{0.1f, 0.15f, 0.25f},
                                                                             {0.2f, 0.25f, 0.26f},
                                                                             {0.45f, 0.5f, 0.6f},
                                                                             {0.25f, 0.5f},
                                                                             {0.5f, 0.5f},
                                                                             {0.74f, 0.76f},
                                                                             {0.76f, 0.74f},
                                                                             {0.1f, 0.3f, 0.9f},
                                                                             {0.f, 1.f},
                                                                             {1.f, 0.99f}}) {
      std::vector<BlobCloud> parts(moments.size());
      chain.append_parts(moments, parts);
      for (size_t i = 0; i < moments.size(); ++i) {
        ASSERT_EQ(parts[i].size(), parts[0].size());
        EXPECT_LT(difference(parts[i], at(chain, moments[i])), 1e-4) << moments[0] << " " << moments[i];
        for (size_t k = 0; k < parts[i].size(); ++k) {
          EXPECT_EQ(parts[i][k].falloff, parts[0][k].falloff);
          EXPECT_GT(parts[i][k].radius, 0);
        }
      }
    }
  }
}

/// A little before an inner end each part is where it is a little after: so numbers may go in a straight line across it.
TEST(Chain, PartsGoThroughAnInnerEndWithoutAJump) {
  const LiquidChain chain = chain_of({row(), mixture(2), ring()}, Correspondence::flow);
  constexpr float k_step = 1e-4f;
  const std::vector<float> moments{0.5f - k_step, 0.5f, 0.5f + k_step};
  std::vector<BlobCloud> parts(moments.size());
  chain.append_parts(moments, parts);
  for (size_t k = 0; k < parts[0].size(); ++k)
    for (const size_t i : {0, 2}) {
      EXPECT_LT(glm::distance(parts[i][k].centre, parts[1][k].centre), 0.01f);
      EXPECT_NEAR(parts[i][k].radius, parts[1][k].radius, 0.01f);
      EXPECT_NEAR(parts[i][k].weight, parts[1][k].weight, 0.01f);
    }
}

/// Where the matter around a point was and will be, as materials ask for it.
BlobFlow flow_at(const LiquidChain& chain, std::vector<float> moments, const Vec3d& p) {
  std::vector<BlobCloud> clouds(moments.size());
  const uint32_t first = moments.size() == 1 ? chain.append_blobs(moments[0], clouds[0]) : chain.append_parts(moments, clouds);
  BlobFlow mean;
  float sum = 0;
  for (uint32_t i = 0; i < clouds[0].size(); ++i) {
    const float f = float(field({clouds[0][i]}, p));
    if (f == 0) continue;
    const BlobFlow flow = chain.flow_of(first + i);
    mean.from += f * flow.from, mean.to += f * flow.to, sum += f;
  }
  return {mean.from / sum, mean.to / sum};
}

// Patterns do not leap at an inner end, whoever asks: moments by themselves, or several of one shutter.
TEST(Chain, MatterFlowsOnThroughInnerEnds) {
  const LiquidChain chain = chain_of({row(), mixture(1), ring(), mixture(4)}, Correspondence::flow);
  const Vec3d in_mixture(1.1, 1, 0), in_ring(4, 0, 0.1);
  for (const auto& [end, p] : {std::pair(1 / 3.f, in_mixture), std::pair(2 / 3.f, in_ring)}) {
    const BlobFlow there = flow_at(chain, {end}, p);
    for (const std::vector<float>& moments : std::vector<std::vector<float>>{{end - 1e-4f},
                                                                             {end + 1e-4f},
                                                                             {end - 1e-4f, end + 1e-4f},
                                                                             {end, end - 0.1f},
                                                                             {end, end + 0.1f},
                                                                             {end + 1e-4f, end + 0.1f},
                                                                             {end, 0.1f, 0.9f}}) {
      const BlobFlow here = flow_at(chain, moments, p);
      EXPECT_LT(glm::distance(here.from, there.from), 0.02f);
      EXPECT_LT(glm::distance(here.to, there.to), 0.02f);
    }
  }
}

} // namespace
} // namespace kelpie
