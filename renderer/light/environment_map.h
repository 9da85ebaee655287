// Light from all around, as the renderer uses it.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/vec.h"
#include "scene/lights.h"

namespace kelpie {

struct LightSample {
  Vec3 direction{0, 1, 0}; ///< unit, towards the light
  Vec3 radiance{0};        ///< scene-linear
  float pdf = 0;           ///< per steradian
};

/// A latitude-longitude map of radiance in its own frame: the middle of the map lies in the direction -z,
/// its right quarter in +x, its top is +y. Strength and rotation are not in here, because they may be
/// animated and the map is shared by all frames: the light that uses the map adds them.
///
/// Immutable once made; may be used from any thread.
class EnvironmentMap {
public:
  /// A Radiance HDR (linear Rec.709) or EXR file (as the header's chromaticities say, else linear Rec.709),
  /// converted to scene-linear. Infinite values become 65504 (the largest half), NaN and negative ones 0, with a warning each. Throws
  /// Error: missing_input when there is no such file; bad_data for any other format, a broken file, or a map of more than 65,536 pixels a
  /// side or 2^27 in all.
  static EnvironmentMap load(const std::string& path, Diagnostics& warnings);
  static EnvironmentMap make(EnvironmentPreset);
  /// Scene-linear, finite, non-negative texels, row by row from the top.
  EnvironmentMap(int width, int height, std::vector<Vec3> texels);

  /// From a unit direction, bilinear between the texels' centres.
  Vec3 radiance(const Vec3& direction) const;

  /// A direction by importance, for u in [0, 1)². The density is constant per steradian within each texel:
  /// the mean over the texel of the bilinear luminance, mixed with 1 % of a uniform density so that
  /// it is nowhere zero. Inverted by guide tables: constant time, and monotone in u (a stratified u
  /// gives stratified directions; an alias table would not).
  LightSample sample(const Vec2& u) const;

  /// The density, per steradian, with which sample() chooses `direction`.
  float pdf(const Vec3& direction) const;

  /// How evenly the light comes from all around: the squared mean of its luminance over the mean of the square. 1 where it is the same
  /// everywhere; of equal light from a part of the sphere it is that part.
  float evenness() const { return evenness_; }

  int width() const { return width_; }
  int height() const { return height_; }
  const std::vector<Vec3>& texels() const { return texels_; }

private:
  void build_distribution();
  /// Bilinear, at (u, v) in [0, 1]² of the map from the top left.
  Vec3 between_texels(float u, float v) const;
  float density(int row, int column) const;

  int width_ = 0, height_ = 0;
  float evenness_ = 1;
  std::vector<Vec3> texels_;
  std::vector<float> row_cdf_, column_cdf_; // height + 1; height × (width + 1)
  std::vector<uint16_t> row_guide_, column_guide_;
  std::vector<float> row_cos_; // cosine of the polar angle at the rows' edges, from 1 down to -1
};

} // namespace kelpie
