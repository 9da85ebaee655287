#include "colour/spaces.h"

#include <cmath>

#include "base/error.h"
#include "colour/config.h"

namespace kelpie {

namespace {

constexpr Chromaticities k_ap1{0.713f, 0.293f, 0.165f, 0.830f, 0.128f, 0.044f, 0.32168f, 0.33767f};
constexpr Chromaticities k_ap0{0.7347f, 0.2653f, 0.f, 1.f, 0.0001f, -0.077f, 0.32168f, 0.33767f};
constexpr Chromaticities k_rec709{0.64f, 0.33f, 0.30f, 0.60f, 0.15f, 0.06f, 0.3127f, 0.3290f};

/// XYZ of chromaticity (x, y) with Y = 1.
Vec3d xyz_from_xy(double x, double y) { return {x / y, 1, (1 - x - y) / y}; }

/// Linear RGB of these primaries to CIE XYZ under their own white: the columns are the primaries, scaled so
/// that RGB (1, 1, 1) is the white.
Mat3d xyz_from_rgb(const Chromaticities& c) {
  // x : y : z rather than X/Y, Z/Y: AP0's green lies at y = 1 and blue below 0, others may lie at y = 0.
  const auto column = [](double x, double y) { return Vec3d(x, y, 1 - x - y); };
  Mat3d m(column(c[0], c[1]), column(c[2], c[3]), column(c[4], c[5]));
  const Vec3d scale = glm::inverse(m) * xyz_from_xy(c[6], c[7]);
  for (int i = 0; i < 3; ++i) m[i] *= scale[i];
  return m;
}

/// Bradford's adaptation: cone-like responses are scaled from one white's to the other's.
Mat3d adapt(const Vec3d& white_from, const Vec3d& white_to) {
  const Mat3d cone(Vec3d(0.8951, -0.7502, 0.0389), Vec3d(0.2664, 1.7135, -0.0685), Vec3d(-0.1614, 0.0367, 1.0296));
  const Vec3d gain = (cone * white_to) / (cone * white_from);
  return glm::inverse(cone) * Mat3d(gain.x, 0, 0, 0, gain.y, 0, 0, 0, gain.z) * cone;
}

Mat3d aces2065_from_rgb(const Chromaticities& c) {
  return glm::inverse(xyz_from_rgb(k_ap0)) * adapt(xyz_from_xy(c[6], c[7]), xyz_from_xy(k_ap0[6], k_ap0[7])) * xyz_from_rgb(c);
}

bool is_gamut(const Chromaticities& c) {
  for (const float v : c)
    if (!std::isfinite(v) || std::abs(v) > 10) return false;
  const double area = (c[2] - c[0]) * (c[5] - c[1]) - (c[4] - c[0]) * (c[3] - c[1]);
  return std::abs(area) > 1e-4 && c[7] > 1e-3;
}

/// The matrix of a linear space, in the terms of this file, from what OCIO makes of its unit vectors.
Mat3d aces2065_from_scene_linear() {
  const auto processor =
      colour::config_in_force()->getProcessor(colour::OCIO::ROLE_SCENE_LINEAR, "aces_interchange")->getDefaultCPUProcessor();
  Mat3d m(1);
  for (int i = 0; i < 3; ++i) {
    float rgb[3] = {i == 0 ? 1.f : 0.f, i == 1 ? 1.f : 0.f, i == 2 ? 1.f : 0.f};
    processor->applyRGB(rgb);
    m[i] = Vec3d(rgb[0], rgb[1], rgb[2]);
  }
  return m;
}

} // namespace

Vec3 to_scene_linear(const Vec3& rgb, const std::string& space_or_role) {
  float v[3] = {rgb.x, rgb.y, rgb.z};
  colour::scene_linear_from(space_or_role)->applyRGB(v);
  return {v[0], v[1], v[2]};
}

void to_scene_linear(float* pixels, size_t pixel_count, int channels, const std::string& space_or_role) {
  colour::apply_in_bands(*colour::scene_linear_from(space_or_role), pixels, pixel_count, channels);
}

void to_scene_linear(float* pixels, size_t pixel_count, int channels, const Chromaticities& primaries) {
  if (!is_gamut(primaries)) throw Error(ExitStatus::bad_data, "the chromaticities in the file's header span no gamut");
  const Mat3d m = aces2065_from_rgb(primaries);
  for (size_t i = 0; i < pixel_count; ++i) {
    float* p = pixels + i * channels;
    const Vec3d rgb = m * Vec3d(p[0], p[1], p[2]);
    for (int c = 0; c < 3; ++c) p[c] = static_cast<float>(rgb[c]);
  }
  to_scene_linear(pixels, pixel_count, channels, k_space_aces2065);
}

std::optional<Chromaticities> scene_linear_chromaticities() {
  if (!colour::config_in_force()->hasRole("aces_interchange")) return {};
  const Mat3d m = aces2065_from_scene_linear();
  for (const Chromaticities& known : {k_ap1, k_rec709, k_ap0}) {
    const Mat3d k = aces2065_from_rgb(known);
    double difference = 0;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) difference = std::max(difference, std::abs(m[i][j] - k[i][j]));
    if (difference < 2e-3) return known; // published matrices are rounded; the three differ by 0.2 and more
  }
  return {};
}

std::string ocio_config_id() { return colour::config_in_force()->getCacheID(); }

} // namespace kelpie
