#include "materials/thin_film.h"

#include <numbers>

namespace kelpie {

namespace {

/// What two rays of unit strength that differ by `path` (micrometres) add to each other: the spectrum of cos(2 pi path /
/// wavelength) as a colour. Belcour and Barla's Gaussians (eq. 15) for CIE XYZ, adapted to the white of the scene's space.
Vec3 interference(float path) {
  constexpr float k_coherent = 25; // beyond, white light shows none: the Gaussians vanish
  if (path > k_coherent) return Vec3(0);
  const float phase = 2 * std::numbers::pi_v<float> * path * 1e-6f;
  const auto gaussian = [&](float value, float position, float variance) {
    return value * std::sqrt(2 * std::numbers::pi_v<float> * variance) * std::cos(position * phase) * std::exp(-variance * phase * phase) /
           1.0685e-7f;
  };
  const Vec3 xyz(gaussian(5.4856e-13f, 1.6810e6f, 4.3278e9f) + gaussian(9.7470e-14f, 2.2399e6f, 4.5282e9f),
                 gaussian(4.4201e-13f, 1.7953e6f, 9.3046e9f), gaussian(5.2481e-13f, 2.2084e6f, 6.6121e9f));
  const Vec3 adapted = xyz * Vec3(0.95265f, 1, 1.00883f); // from equal energy to ACES white
  return {1.6410234f * adapted.x - 0.3248033f * adapted.y - 0.2364247f * adapted.z,
          -0.6636629f * adapted.x + 1.6153316f * adapted.y + 0.0167563f * adapted.z,
          0.0117219f * adapted.x - 0.0082844f * adapted.y + 0.9883949f * adapted.z};
}

/// Amplitudes that one face reflects: with both their squares' mean is fresnel_dielectric.
struct Amplitudes {
  float s, p;
};
Amplitudes amplitudes(float cosine, float beyond, float eta) {
  return {(cosine - eta * beyond) / (cosine + eta * beyond), (eta * cosine - beyond) / (eta * cosine + beyond)};
}

/// Airy's sum for one polarisation (Belcour and Barla, eq. 7 and 8): `first` is the amplitude that the film's outer face reflects,
/// `second` that of the inner one; `waves[m - 1]` is the interference of rays that differ by m ways through the film.
Vec3 airy(float first, const Vec3& second, const std::array<Vec3, 3>& waves) {
  const float passed = 1 - first * first;
  const Vec3 back = second * second, again = back * passed * passed / (Vec3(1) - back * (first * first));
  Vec3 sum = Vec3(first * first) + again, power(1);
  for (const Vec3& wave : waves) {
    power *= second * -first;
    sum += (again - Vec3(passed)) * power * wave * 2.f;
  }
  return sum;
}

} // namespace

Vec3 ThinFilm::on_dielectric(float cosine, float eta) const {
  const float film_eta = ior_ / ior_above_, in_film = refracted_cosine(cosine, film_eta), beyond = refracted_cosine(cosine, eta);
  if (in_film <= 0 || beyond <= 0) return Vec3(1);
  const Amplitudes outer = amplitudes(cosine, in_film, film_eta), inner = amplitudes(in_film, beyond, eta / film_eta);
  const std::array<Vec3, 3> waves = interferences(in_film);
  const Vec3 mean = 0.5f * (airy(outer.s, Vec3(inner.s), waves) + airy(outer.p, Vec3(inner.p), waves));
  return glm::clamp(mean, Vec3(0), Vec3(1));
}

// The phase that a metal adds is taken for that of a perfect one: half a wave.
Vec3 ThinFilm::on_metal(float cosine, const F82Tint& metal) const {
  const float film_eta = ior_ / ior_above_, in_film = refracted_cosine(cosine, film_eta);
  if (in_film <= 0) return Vec3(1);
  const Amplitudes outer = amplitudes(cosine, in_film, film_eta);
  const Vec3 inner = glm::sqrt(glm::min(metal(in_film), Vec3(1)));
  const std::array<Vec3, 3> waves = interferences(in_film);
  const Vec3 mean = 0.5f * (airy(outer.s, -inner, waves) + airy(outer.p, inner, waves));
  return glm::clamp(mean, Vec3(0), Vec3(1));
}

std::array<Vec3, 3> ThinFilm::interferences(float cosine_in_film) const {
  const float path = 2 * ior_ * thickness_ * cosine_in_film;
  return {interference(path), interference(2 * path), interference(3 * path)};
}

} // namespace kelpie
