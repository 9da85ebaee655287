// Which of the shapes around a place fills it, and which surfaces can be seen there.
#pragma once

#include <algorithm>
#include <functional>
#include <optional>
#include <vector>

#include "renderer/trace/shape_set.h"
#include "scene/scene.h"

namespace kelpie {

/// Shapes that lie in one another, in an order (Schmidt and Budge 2002, "Simple Nested Dielectrics in Ray Traced Images"): where
/// several overlap, the one of the highest priority fills the place, and the surfaces of the lower ones are not there. So water
/// may reach into the wall of its glass, and leaves no gap.
class Media {
public:
  Media() = default;
  explicit Media(const std::vector<SampledShape>& shapes) {
    for (const SampledShape& s : shapes) priorities_.push_back(s.priority);
    hides_ = std::adjacent_find(priorities_.begin(), priorities_.end(), std::not_equal_to<>()) != priorities_.end();
  }

  /// The shape that fills a place in all of `around`; none in the open. Of equal priorities the later shape's counts, whichever
  /// the ray came to first.
  std::optional<uint32_t> filling(const ShapeSet& around) const {
    std::optional<uint32_t> best;
    for (const uint32_t shape : around)
      if (!best || std::pair(priorities_[shape], shape) > std::pair(priorities_[*best], *best)) best = shape;
    return best;
  }

  /// Whether the surface of `shape` is there for a ray that arrives at it in all of `around`: not in a shape of higher priority.
  bool is_seen(uint32_t shape, const ShapeSet& around) const {
    return std::none_of(around.begin(), around.end(), [&](uint32_t other) { return priorities_[other] > priorities_[shape]; });
  }

  /// Whether some surface may be hidden at all: there are several priorities.
  bool hides() const { return hides_; }

private:
  std::vector<int> priorities_; ///< by shape
  bool hides_ = false;
};

} // namespace kelpie
