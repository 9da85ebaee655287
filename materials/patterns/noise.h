// Gradient noise and its fractal sums, the same on every machine: integer hashes, and arithmetic that IEEE 754 rounds alike.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "base/vec.h"
#include "materials/patterns/footprint.h"

namespace kelpie {

/// Scrambles 32 bits, of one number or of each in a vector (Chris Wellons, "Prospecting for hash functions", 2018: lowbias32).
template <class Bits>
constexpr Bits scrambled(Bits h) {
  h ^= h >> 16;
  h *= 0x7feb352du;
  h ^= h >> 15;
  h *= 0x846ca68bu;
  return h ^ (h >> 16);
}

/// Four numbers side by side: what processors calculate at once, by the vectors that GCC and Clang have on all of them.
using Floats4 = float __attribute__((vector_size(16)));
using Bits4 = uint32_t __attribute__((vector_size(16)));
using Ints4 = int32_t __attribute__((vector_size(16)));

/// A number in [0, 1) of 24 bits.
constexpr float unit_of(uint32_t hash) { return static_cast<float>(hash >> 8) * 0x1p-24f; }

/// The cell of the integer lattice that a point is in, and where in it.
class LatticeCell {
public:
  /// What lies beyond 2^30 is in one cell.
  LatticeCell(const Vec3& p, uint32_t seed) : x_(floored(p.x)), y_(floored(p.y)), z_(floored(p.z)), seed_(scrambled(seed)) {
    fraction_ = p - Vec3(static_cast<float>(x_), static_cast<float>(y_), static_cast<float>(z_));
  }

  /// The place in the cell, in [0, 1]^3.
  const Vec3& fraction() const { return fraction_; }
  /// The hash of the lattice point so many cells from the cell's least corner.
  uint32_t hash(int dx, int dy, int dz) const { return scrambled(x_part(dx) ^ y_part(dy) ^ z_part(dz)); }
  /// Those of the corners (0, 0), (1, 0), (0, 1), (1, 1) of the layer dz.
  Bits4 hashes(int dz) const {
    const uint32_t x0 = x_part(0), x1 = x_part(1), y0 = y_part(0), y1 = y_part(1);
    return scrambled(Bits4{x0 ^ y0, x1 ^ y0, x0 ^ y1, x1 ^ y1} ^ z_part(dz));
  }

private:
  uint32_t x_part(int d) const { return static_cast<uint32_t>(x_ + d) * 0x9e3779b1u; }
  uint32_t y_part(int d) const { return static_cast<uint32_t>(y_ + d) * 0x85ebca77u; }
  uint32_t z_part(int d) const { return static_cast<uint32_t>(z_ + d) * 0xc2b2ae3du ^ seed_; }
  static int32_t floored(float v) {
    const auto whole = static_cast<int32_t>(std::clamp(v, -0x1p30f, 0x1p30f));
    return whole - (v < static_cast<float>(whole));
  }

  int32_t x_, y_, z_;
  uint32_t seed_;
  Vec3 fraction_;
};

/// A random function at a place: its mean over a footprint, how that changes with the place, and its variance about that mean beside
/// what the gradient explains.
struct NoiseSample {
  float value = 0;
  Vec3 gradient{0};
  float variance = 0;
};

namespace detail {
/// Perlin's quintic between two lattice points, and its slope ("Improving noise", 2002).
inline float fade(float t) { return t * t * t * (t * (t * 6 - 15) + 10); }
inline float fade_slope(float t) { return 30 * t * t * (t * (t - 2) + 1); }
/// The last ten bits as numbers from -1 to 1.
inline Floats4 signed_unit(Bits4 bits) {
  return __builtin_convertvector(reinterpret_cast<Ints4>(bits & 1023u), Floats4) * (2 / 1023.f) - 1;
}

/// Makes the variance of `gradient_noise` 1: measured, as the test does.
inline constexpr float k_noise_scale = 5.23f;
/// The mean square of one component of its gradient, measured.
inline constexpr float k_noise_slope = 6.81f;
} // namespace detail

/// Gradient noise (Perlin 2002) with lattice gradients of independent components: mean 0, variance 1, features about one unit wide.
inline NoiseSample gradient_noise(const Vec3& p, uint32_t seed) {
  const LatticeCell cell(p, seed);
  const Vec3& f = cell.fraction();
  const Vec3 far(detail::fade(f.x), detail::fade(f.y), detail::fade(f.z)), near = 1.f - far;
  const Vec3 slope(detail::fade_slope(f.x), detail::fade_slope(f.y), detail::fade_slope(f.z));
  // Lanes: the corners of a layer, as LatticeCell::hashes has them.
  const Floats4 x{near.x, far.x, near.x, far.x}, y{near.y, near.y, far.y, far.y};
  const Floats4 x_slope{-slope.x, slope.x, -slope.x, slope.x}, y_slope{-slope.y, -slope.y, slope.y, slope.y};
  const Floats4 to_x{f.x, f.x - 1, f.x, f.x - 1}, to_y{f.y, f.y, f.y - 1, f.y - 1};
  Floats4 value{}, gradient_x{}, gradient_y{}, gradient_z{};
  for (int layer = 0; layer < 2; ++layer) {
    const Bits4 h = cell.hashes(layer);
    const Floats4 gx = detail::signed_unit(h), gy = detail::signed_unit(h >> 10), gz = detail::signed_unit(h >> 20);
    const Floats4 height = gx * to_x + gy * to_y + gz * (layer ? f.z - 1 : f.z);
    const float z = layer ? far.z : near.z, z_slope = layer ? slope.z : -slope.z;
    const Floats4 weight = x * y * z;
    value += weight * height;
    gradient_x += weight * gx + x_slope * y * z * height;
    gradient_y += weight * gy + x * y_slope * z * height;
    gradient_z += weight * gz + x * y * z_slope * height;
  }
  const auto sum = [](const Floats4& lanes) { return ((lanes[0] + lanes[1]) + (lanes[2] + lanes[3])) * detail::k_noise_scale; };
  return {sum(value), Vec3(sum(gradient_x), sum(gradient_y), sum(gradient_z))};
}

/// The part of a normal distribution of mean 0 and variance 1 that is below x: within 3e-7 (Abramowitz and Stegun, 7.1.28).
inline float normal_below(float x) {
  const float t = std::abs(x) * 0.70710678f;
  float q =
      1 + t * (0.0705230784f + t * (0.0422820123f + t * (0.0092705272f + t * (0.0001520143f + t * (0.0002765672f + t * 0.0000430638f)))));
  for (int i = 0; i < 4; ++i) q *= q;
  const float beyond = 0.5f / q;
  return x < 0 ? beyond : 1 - beyond;
}

/// 1 where less than two units, and more, of a pattern are in a footprint `width` wide: from there on it is its mean; 0 where one sees it.
inline float unseen(float width) {
  const float t = std::clamp((width - 0.5f) / 1.5f, 0.f, 1.f);
  return t * t * (3 - 2 * t);
}

/// A sum of octaves: each has `lacunarity` times the frequency of the one before, and `gain` times its amplitude.
struct Fractal {
  float octaves = 4; ///< of the last there may be a part
  float lacunarity = 2;
  float gain = 0.5f;
  uint32_t seed = 0;
};

/// How much of an octave of unit frequency is left of its value over a footprint, and the variance of what is not, beside what its
/// gradient explains. As if its spectrum were normal: along each side of the footprint the power shrinks by 1 / sqrt(1 + slope w^2 / 6),
/// which for narrow footprints is what the gradient explains. Where the narrower side is two units wide nothing is left.
struct OctaveFilter {
  float amplitude = 1, variance = 0;

  OctaveFilter(float u2, float v2) {
    constexpr float k_rate = detail::k_noise_slope / 6;
    const float seen = 1 - unseen(std::sqrt(std::min(u2, v2)));
    const float power = seen * seen / std::sqrt((1 + k_rate * u2) * (1 + k_rate * v2));
    amplitude = std::sqrt(power);
    variance = std::max(0.f, 1 - power * (1 + 0.5f * k_rate * (u2 + v2)));
  }
};

/// Turned so that neither the axes nor the planes between them are special to a lattice; and back.
inline Vec3 turned(const Vec3& q) {
  return Vec3(0.8f * q.y + 0.6f * q.z, -0.8f * q.x + 0.36f * q.y - 0.48f * q.z, -0.6f * q.x - 0.48f * q.y + 0.64f * q.z);
}
inline Vec3 turned_back(const Vec3& q) {
  return Vec3(-0.8f * q.y - 0.6f * q.z, 0.8f * q.x + 0.36f * q.y - 0.48f * q.z, 0.6f * q.x - 0.48f * q.y + 0.64f * q.z);
}

/// The sum of octaves with variance 1 (and features about one unit wide, and finer). Octaves are turned against each other, so that
/// no axis and no lattice is seen. `blur` is a variance of p in every direction, beside the footprint's.
inline NoiseSample fractal_noise(const Vec3& p, const Footprint& footprint, const Fractal& fractal, float blur = 0) {
  static constexpr int k_most = 12;
  struct Octave {
    Vec3 p;
    float amplitude, u2, v2;
  };
  std::array<Octave, k_most> octaves;
  int count = 0;
  float power = 0, amplitude = 1;
  Octave octave{p, 1, glm::dot(footprint.u, footprint.u) + 12 * blur, glm::dot(footprint.v, footprint.v) + 12 * blur};
  for (float left = std::min(std::max(fractal.octaves, 1.f), static_cast<float>(k_most)); left > 0; left -= 1) {
    octave.p = turned(octave.p) + Vec3(0.37f, 0.59f, 0.71f); // the origin is no lattice point
    octave.amplitude = amplitude * std::min(left, 1.f);
    power += octave.amplitude * octave.amplitude;
    octaves[static_cast<size_t>(count++)] = octave;
    octave.p *= fractal.lacunarity;
    octave.u2 *= fractal.lacunarity * fractal.lacunarity, octave.v2 *= fractal.lacunarity * fractal.lacunarity;
    amplitude *= fractal.gain;
  }
  NoiseSample sum;
  for (int i = count; i-- > 0;) { // from the finest: the gradient is brought back one octave a step
    const Octave& o = octaves[static_cast<size_t>(i)];
    if (i + 1 < count) sum.gradient *= fractal.lacunarity;
    const OctaveFilter filter(o.u2, o.v2);
    sum.variance += o.amplitude * o.amplitude * filter.variance;
    if (filter.amplitude > 0) {
      const NoiseSample noise = gradient_noise(o.p, fractal.seed + static_cast<uint32_t>(i));
      sum.value += o.amplitude * filter.amplitude * noise.value;
      sum.gradient += o.amplitude * filter.amplitude * noise.gradient;
    }
    sum.gradient = turned_back(sum.gradient);
  }
  const float scale = 1 / std::sqrt(power);
  return {sum.value * scale, sum.gradient * scale, sum.variance / power};
}

} // namespace kelpie
