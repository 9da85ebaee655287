#include "materials/subsurface.h"

#include <cmath>
#include <numbers>

#include "base/orthonormal_basis.h"
#include "materials/bsdf.h"

namespace kelpie {

namespace {

constexpr float k_pi = std::numbers::pi_v<float>;
/// Clamps of what else would be no number; far from what can be seen.
constexpr float k_least_radius = 1e-6f, k_most_albedo = 0.9999f, k_least_albedo = 0.1f;

/// Each step away from the surface makes what is left weigh more where others are drawn to it: from here on none is, so that no walk is a
/// firefly.
constexpr float k_heavy = 1.5f;

/// Of a half-space that is lit from all around: the albedo of one collision, by how much comes out.
float single_albedo(float reflectance, float g) {
  const float c = std::clamp(reflectance, 0.f, 1.f);
  const float s = std::max(0.f, 4.09712f + 4.20863f * c - std::sqrt(9.59217f + 41.6808f * c + 17.7126f * c * c));
  return std::clamp((1 - s * s) / (1 - g * s * s), 0.f, 1.f);
}

/// The discrete eigenvalue of one-dimensional transport with isotropic scattering (their fit).
float diffusion_length(float albedo) {
  const float a = std::clamp(albedo, k_least_albedo, k_most_albedo);
  return 1 / std::sqrt(1 - std::pow(a, 2.44294f - 0.0215813f * a + 0.578637f / a));
}

float henyey_greenstein(float g, float cosine) {
  const float d = std::max(1e-6f, 1 + g * g - 2 * g * cosine);
  return (1 - g * g) / (4 * k_pi * d * std::sqrt(d));
}
float sampled_cosine(float g, float u) {
  if (std::abs(g) < 1e-3f) return 1 - 2 * u;
  const float s = (1 - g * g) / (1 - g + 2 * g * u);
  return std::clamp((1 + g * g - s * s) / (2 * g), -1.f, 1.f);
}

/// A unit vector with this cosine to another.
Vec3 around(const Vec3& axis, float cosine, float u) {
  const float sine = std::sqrt(std::max(0.f, 1 - cosine * cosine)), phi = 2 * k_pi * u;
  return glm::normalize(OrthonormalBasis(axis).world_from_local({sine * std::cos(phi), sine * std::sin(phi), cosine}));
}

int chosen_channel(const Vec3& probabilities, float& u) {
  int channel = 0;
  while (channel < 2 && u >= probabilities[channel]) u -= probabilities[channel++];
  u = std::min(u / std::max(probabilities[channel], 1e-12f), 0x1.fffffep-1f);
  return channel;
}

} // namespace

SubsurfaceMedium::SubsurfaceMedium(const SurfaceParameters& s) : anisotropy(s.subsurface_scatter_anisotropy) {
  for (int c = 0; c < 3; ++c) {
    extinction[c] = 1 / std::max(k_least_radius, s.subsurface_radius * s.subsurface_radius_scale.rgb[c]);
    albedo[c] = single_albedo(s.subsurface_color.rgb[c], anisotropy);
  }
}

SubsurfaceMedium SubsurfaceMedium::no_denser_than(float length) const {
  SubsurfaceMedium medium = *this;
  medium.extinction = glm::min(extinction, Vec3(1 / length));
  return medium;
}

SubsurfaceWalk::SubsurfaceWalk(const SubsurfaceMedium& medium, const Vec3& normal, const Vec3& direction)
    : medium_(medium), normal_(normal), direction_(direction), guided_share_(0.5f * (1 - std::abs(medium.anisotropy))),
      cosine_(glm::dot(normal, direction)), of_light_(channel_probabilities()), of_guide_(0) {
  for (int c = 0; c < k_channels; ++c) nu_[c] = diffusion_length(medium.albedo[c]);
}

/// The brightest channels are the likeliest.
Vec3 SubsurfaceWalk::channel_probabilities() const {
  const Vec3 worth = throughput_ * medium_.albedo;
  const float sum = worth.x + worth.y + worth.z;
  return sum > 0 ? worth / sum : Vec3(1 / 3.f);
}

float SubsurfaceWalk::guided_cosine_density(int channel, float cosine) const {
  const float nu = nu_[channel];
  return 1 / ((nu - cosine) * std::log((nu + 1) / (nu - 1)));
}

float SubsurfaceWalk::next_distance(Vec2 u) {
  const Vec3& choices = is_guided_ ? of_guide_ : of_light_;
  const float sum = choices.x + choices.y + choices.z;
  const int channel = chosen_channel(choices / sum, u.x);
  return -std::log(1 - u.y) / (medium_.extinction[channel] * (is_guided_ ? stretch(channel) : 1));
}

/// By what light does, over the density of all choices that could have led there.
void SubsurfaceWalk::weigh(const Vec3& light, const Vec3& of_light, const Vec3& of_guide) {
  const float density = glm::dot(of_light_, of_light) + glm::dot(of_guide_, of_guide);
  throughput_ = density > 0 ? throughput_ * (phase_ / density) * light : Vec3(0);
}

void SubsurfaceWalk::leave(float distance) {
  const Vec3 straight = glm::exp(-distance * medium_.extinction);
  const Vec3 stretches(stretch(0), stretch(1), stretch(2));
  weigh(straight, straight, glm::exp(-distance * medium_.extinction * stretches));
}

void SubsurfaceWalk::collide(float distance, Vec2 u, float choice) {
  const Vec3 straight = medium_.extinction * glm::exp(-distance * medium_.extinction);
  const Vec3 drawn = medium_.extinction * Vec3(stretch(0), stretch(1), stretch(2));
  weigh(straight * medium_.albedo, straight, drawn * glm::exp(-distance * drawn));

  const Vec3 channels = channel_probabilities();
  const float guided = largest(throughput_) < k_heavy ? guided_share_ : 0;
  is_guided_ = choice < guided;
  if (is_guided_) {
    float rest = choice / guided;
    const float nu = nu_[chosen_channel(channels, rest)];
    const float cosine = std::clamp(nu - (nu + 1) * std::pow((nu - 1) / (nu + 1), u.x), -1.f, 1.f);
    const Vec3 before = direction_;
    direction_ = around(normal_, cosine, u.y);
    phase_ = henyey_greenstein(medium_.anisotropy, glm::dot(before, direction_));
  } else {
    const float cosine = sampled_cosine(medium_.anisotropy, u.x);
    direction_ = around(direction_, cosine, u.y);
    phase_ = henyey_greenstein(medium_.anisotropy, cosine);
  }
  cosine_ = glm::dot(normal_, direction_);
  of_light_ = (1 - guided) * phase_ * channels;
  for (int c = 0; c < k_channels; ++c) of_guide_[c] = guided * channels[c] * guided_cosine_density(c, cosine_) / (2 * k_pi);
}

} // namespace kelpie
