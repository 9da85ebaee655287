// Sample points of many samples of a pixel at once.
#pragma once

#include <cstddef>

#include "renderer/integrate/sampler.h"

namespace kelpie {

/// What Sampler::next_pair() yields of samples first, first + 1, … of a pixel of a frame, after `pair` calls: to the last bit.
/// SIMD, dispatched at run time.
void next_pairs(PixelSeed, uint32_t pair, uint32_t first, size_t count, float* x, float* y);
/// The same of Sampler::next().
void next_numbers(PixelSeed, uint32_t pair, uint32_t first, size_t count, float* x);

} // namespace kelpie
