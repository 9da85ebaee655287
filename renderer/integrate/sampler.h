// Sample points: the Sobol sequence's first two dimensions, Owen-scrambled and padded to any number of
// pairs (Burley 2020, "Practical hash-based Owen scrambling"; permutation by Laine and Karras 2011).
#pragma once

#include <cstdint>

#include "base/vec.h"

namespace kelpie {

/// A good 32-bit mix of two numbers.
inline uint32_t hash(uint32_t a, uint32_t b) {
  uint64_t x = (uint64_t(a) << 32 | b) + 0x9e3779b97f4a7c15u;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u; // the finaliser of SplitMix64
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
  return static_cast<uint32_t>((x ^ (x >> 31)) >> 16);
}

/// What the pattern of a pixel in a frame is made of.
struct PixelSeed {
  uint32_t seed;

  PixelSeed(uint32_t x, uint32_t y, uint32_t frame) : seed(hash(hash(x, y), frame)) {}
};

/// The points of one sample of one pixel of one frame: they depend on nothing else, so neither threads nor
/// crop nor the order of tiles changes a picture. Each call yields the next, independent point.
class Sampler {
public:
  Sampler(uint32_t x, uint32_t y, uint32_t frame, uint32_t sample) : Sampler(PixelSeed(x, y, frame), sample, 0) {}
  /// After so many calls.
  Sampler(PixelSeed pixel, uint32_t sample, uint32_t calls) : sample_reversed_(reverse(sample)), seed_(pixel.seed), pair_(calls) {}

  /// The factors of the scramble.
  static constexpr uint32_t k_scramble[] = {0x6c50b47cu, 0xb82f1e52u, 0xc7afe638u, 0x8d22f6e6u};

  /// The next number in [0, 1); the same call of other samples of the pixel fills it evenly.
  float next() { return number_of(hash(seed_, pair_++)); }

  /// The next point in [0, 1)^2; the same call of other samples of the pixel fills the square evenly.
  Vec2 next_pair() { return pair_of(hash(seed_, pair_++)); }

  /// What next_pair() would yield, and in z a number that fills [0, 1) evenly by itself.
  Vec3 next_triple() {
    const uint32_t seed = hash(seed_, pair_++);
    return {pair_of(seed), number_of(hash(seed, 3))};
  }

private:
  float number_of(uint32_t seed) const {
    const uint32_t index = reverse(scramble_reversed(sample_reversed_, seed));
    return to_unit(reverse(scramble_reversed(index, hash(seed, 1))));
  }
  Vec2 pair_of(uint32_t seed) const {
    const uint32_t index = reverse(scramble_reversed(sample_reversed_, seed));
    // In reversed bits the sequence's first dimension is the index itself.
    return {to_unit(reverse(scramble_reversed(index, hash(seed, 1)))),
            to_unit(reverse(scramble_reversed(sobol_second_reversed(index), hash(seed, 2))))};
  }
  static uint32_t reverse(uint32_t x) {
    x = x >> 16 | x << 16;
    x = (x & 0x00ff00ffu) << 8 | (x & 0xff00ff00u) >> 8;
    x = (x & 0x0f0f0f0fu) << 4 | (x & 0xf0f0f0f0u) >> 4;
    x = (x & 0x33333333u) << 2 | (x & 0xccccccccu) >> 2;
    return (x & 0x55555555u) << 1 | (x & 0xaaaaaaaau) >> 1;
  }
  /// The second dimension, bits reversed. Its matrix is Pascal's triangle modulo 2, a product of five shifts.
  static uint32_t sobol_second_reversed(uint32_t index) {
    index ^= index >> 16;
    index ^= (index & 0xff00ff00u) >> 8;
    index ^= (index & 0xf0f0f0f0u) >> 4;
    index ^= (index & 0xccccccccu) >> 2;
    return index ^ (index & 0xaaaaaaaau) >> 1;
  }
  /// A random permutation of numbers with their bits reversed, in which each bit depends on the lower ones only.
  static uint32_t scramble_reversed(uint32_t x, uint32_t seed) {
    x += seed;
    for (const uint32_t factor : k_scramble) x ^= x * factor;
    return x;
  }
  static float to_unit(uint32_t x) { return static_cast<float>(x >> 8) * 0x1p-24f; }

  uint32_t sample_reversed_, seed_, pair_;
};

} // namespace kelpie
