// The shapes that a point lies in.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

namespace kelpie {

/// A handful of shapes: a ray carries one, so it is a value without memory of its own.
class ShapeSet {
public:
  /// More shapes than this around one place are forgotten: a ray then meets their surfaces as if from outside.
  static constexpr size_t k_most = 8;

  bool is_empty() const { return count_ == 0; }
  bool contains(uint32_t shape) const { return std::find(begin(), end(), shape) != end(); }
  void add(uint32_t shape) {
    if (count_ < k_most && !contains(shape)) shapes_[count_++] = shape;
  }
  void remove(uint32_t shape) {
    const auto at = std::find(shapes_.begin(), shapes_.begin() + count_, shape);
    if (at != shapes_.begin() + count_) *at = shapes_[--count_];
  }

  /// In no particular order.
  const uint32_t* begin() const { return shapes_.data(); }
  const uint32_t* end() const { return shapes_.data() + count_; }

private:
  std::array<uint32_t, k_most> shapes_{};
  uint32_t count_ = 0;
};

} // namespace kelpie
