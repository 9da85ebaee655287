#include "renderer/light/environment_map.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "colour/colour.h"

namespace kelpie {

namespace {

constexpr double k_uniform_part = 0.01;

/// Where in a cumulative distribution u lies: its step, and how far into it.
struct Inverse {
  int step;
  float offset; // [0, 1)
};

/// `cdf` has n + 1 ascending entries from 0 to 1; guide[k] is the step that holds k/n.
Inverse invert(const float* cdf, const uint16_t* guide, int n, float u) {
  int i = guide[std::min(static_cast<int>(u * float(n)), n - 1)];
  while (i + 1 < n && cdf[i + 1] <= u) ++i;
  while (i > 0 && cdf[i] > u) --i; // u·n rounded up
  return {i, std::clamp((u - cdf[i]) / (cdf[i + 1] - cdf[i]), 0.f, 0x1.fffffep-1f)};
}

/// Fills a distribution whose steps are proportional to `weights`, mixed with `uniform` (which sums to 1).
template <class Uniform>
void fill(const double* weights, int n, Uniform&& uniform, float* cdf, uint16_t* guide) {
  double total = 0, sum = 0;
  for (int i = 0; i < n; ++i) total += weights[i];
  for (int i = 0; i < n; ++i) {
    cdf[i] = static_cast<float>(sum);
    sum += total > 0 ? (1 - k_uniform_part) * weights[i] / total + k_uniform_part * uniform(i) : uniform(i);
  }
  cdf[n] = 1;
  for (int k = 0, i = 0; k < n; ++k) {
    while (i + 1 < n && cdf[i + 1] <= float(k) / float(n)) ++i;
    guide[k] = static_cast<uint16_t>(i);
  }
}

} // namespace

EnvironmentMap::EnvironmentMap(int width, int height, std::vector<Vec3> texels)
    : width_(width), height_(height), texels_(std::move(texels)) {
  build_distribution();
}

void EnvironmentMap::build_distribution() {
  const size_t w = size_t(width_), h = size_t(height_);
  row_cdf_.resize(h + 1), row_guide_.resize(h), row_cos_.resize(h + 1);
  column_cdf_.resize(h * (w + 1)), column_guide_.resize(h * w);
  for (size_t r = 0; r <= h; ++r) row_cos_[r] = static_cast<float>(std::cos(std::numbers::pi * double(r) / double(h)));
  row_cos_[h] = -1;

  // The mean of a bilinear function over a texel is a tent of 1/8, 6/8, 1/8 in each direction: what the
  // texel's neighbours shine into it is sampled too.
  std::vector<double> light(w), mean(w), rows(h);
  double sum = 0, sum_of_squares = 0; // over the sphere
  for (size_t r = 0; r < h; ++r) {
    const size_t above = r > 0 ? r - 1 : 0, below = std::min(r + 1, h - 1);
    for (size_t c = 0; c < w; ++c)
      light[c] = 0.75 * luminance(texels_[r * w + c]) + 0.125 * (luminance(texels_[above * w + c]) + luminance(texels_[below * w + c]));
    for (size_t c = 0; c < w; ++c) mean[c] = 0.75 * light[c] + 0.125 * (light[(c + w - 1) % w] + light[(c + 1) % w]);
    fill(
        mean.data(), width_, [&](int) { return 1.0 / double(w); }, &column_cdf_[r * (w + 1)], &column_guide_[r * w]);
    const double solid_angle = double(row_cos_[r]) - double(row_cos_[r + 1]); // but for a constant
    for (const double m : mean) rows[r] += m, sum_of_squares += m * m * solid_angle;
    rows[r] *= solid_angle, sum += rows[r];
  }
  if (sum_of_squares > 0) evenness_ = static_cast<float>(sum * sum / (2 * double(w) * sum_of_squares));
  const auto solid_angle = [&](int r) { return (double(row_cos_[r]) - double(row_cos_[r + 1])) / 2; };
  fill(rows.data(), height_, solid_angle, row_cdf_.data(), row_guide_.data());
}

// From the rounded distributions themselves: the density is exactly the one that sample() has.
float EnvironmentMap::density(int row, int column) const {
  const float* cdf = &column_cdf_[size_t(row) * size_t(width_ + 1) + size_t(column)];
  const float probability = (row_cdf_[row + 1] - row_cdf_[row]) * (cdf[1] - cdf[0]);
  return probability * float(width_) / (2 * std::numbers::pi_v<float> * (row_cos_[row] - row_cos_[row + 1]));
}

Vec3 EnvironmentMap::between_texels(float u, float v) const {
  const float s = u * float(width_) - 0.5f, t = v * float(height_) - 0.5f;
  const float column = std::floor(s), row = std::floor(t), a = s - column, b = t - row;
  const int left = static_cast<int>(column) < 0 ? width_ - 1 : std::min(static_cast<int>(column), width_ - 1);
  const int right = left + 1 < width_ ? left + 1 : 0;
  const int top = std::max(static_cast<int>(row), 0), bottom = std::min(static_cast<int>(row) + 1, height_ - 1);
  const Vec3 *upper = &texels_[size_t(top) * size_t(width_)], *lower = &texels_[size_t(bottom) * size_t(width_)];
  return (upper[left] * (1 - a) + upper[right] * a) * (1 - b) + (lower[left] * (1 - a) + lower[right] * a) * b;
}

Vec3 EnvironmentMap::radiance(const Vec3& d) const {
  return between_texels(0.5f + std::atan2(d.x, -d.z) / (2 * std::numbers::pi_v<float>),
                        std::acos(std::clamp(d.y, -1.f, 1.f)) / std::numbers::pi_v<float>);
}

LightSample EnvironmentMap::sample(const Vec2& u) const {
  const Inverse row = invert(row_cdf_.data(), row_guide_.data(), height_, u.y);
  const size_t r = size_t(row.step), w = size_t(width_);
  const Inverse column = invert(&column_cdf_[r * (w + 1)], &column_guide_[r * w], width_, u.x);
  const float y = row_cos_[r] + (row_cos_[r + 1] - row_cos_[r]) * row.offset, sine = std::sqrt(std::max(0.f, 1 - y * y));
  const float place = (float(column.step) + column.offset) / float(width_), phi = 2 * std::numbers::pi_v<float> * (place - 0.5f);
  LightSample sample;
  sample.direction = {sine * std::sin(phi), y, -sine * std::cos(phi)};
  sample.radiance = between_texels(place, std::acos(y) / std::numbers::pi_v<float>);
  sample.pdf = density(row.step, column.step);
  return sample;
}

float EnvironmentMap::pdf(const Vec3& d) const {
  const float s = 0.5f + std::atan2(d.x, -d.z) / (2 * std::numbers::pi_v<float>),
              t = std::acos(std::clamp(d.y, -1.f, 1.f)) / std::numbers::pi_v<float>;
  return density(std::clamp(static_cast<int>(t * float(height_)), 0, height_ - 1),
                 std::clamp(static_cast<int>(s * float(width_)), 0, width_ - 1));
}

} // namespace kelpie
