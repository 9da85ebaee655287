// The time in which a part of a field lives.
#pragma once

#include <algorithm>
#include <compare>

namespace kelpie {

/// When the parent is at frame f, what is below is at (f - offset) * scale: it begins `offset` frames later, and is `scale` times as
/// fast.
struct TimeMap {
  double offset = 0, scale = 1;

  /// The frame below at a frame of the parent.
  double at(double frame) const { return (frame - offset) * scale; }
  /// The frame of the parent at a frame below.
  double frame_of(double below) const { return below / scale + offset; }
  /// From the parent through this map and then the next.
  TimeMap then(const TimeMap& next) const {
    constexpr double k_far = 1e15; // whatever a scene says, frames stay numbers
    return {std::clamp(offset + next.offset / scale, -k_far, k_far), scale * next.scale};
  }
  friend auto operator<=>(const TimeMap&, const TimeMap&) = default;
};

} // namespace kelpie
