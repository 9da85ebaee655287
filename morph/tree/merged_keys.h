// A value that is computed from others, as an ordinary curve of keys.
#pragma once

#include "base/kind.h"

namespace kelpie {

/// A curve, and how far it is from what it stands for, at most.
template <class T>
struct MergedKeys {
  std::vector<Key<T>> keys; ///< of a Hermite curve that is held outside
  double error = 0;         ///< over its frames, at places between those where it was made
};

/// A Hermite curve that is the value at the frames from `first` to `last`: of T float, Vec3 or Colour. It has a key wherever the value has
/// a break, and between two of them the least order that does. So what is interpolated between two curves by a third is exact but for
/// rounding, with at most as many keys as all three have; a part that is no polynomial of degree 9 or less is halved until it nearly is
/// one. Where the value jumps there are two keys. Where it is in `range`, so is the curve, as far as readers of scenes look. Source:
/// Barbier, Galin, Akkouche, merging of key frames; methods.md section 2 (order n + 2, and derivatives of either side).
template <class T>
MergedKeys<T> merged_keys(const Animated<T>& value, double first, double last, const Range& range = {});

} // namespace kelpie
