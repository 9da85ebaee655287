#pragma once

#include <new>

#include <hwy/aligned_allocator.h>

namespace kelpie {

using AlignedFloats = hwy::AlignedFreeUniquePtr<float[]>;

/// As many numbers, which are anything, aligned for any vector. Throws std::bad_alloc.
inline AlignedFloats aligned_floats(size_t count) {
  AlignedFloats out = hwy::AllocateAligned<float>(count);
  if (!out) throw std::bad_alloc();
  return out;
}

} // namespace kelpie
