// How the values of a pattern are distributed in space.
#pragma once

#include <algorithm>
#include <random>
#include <vector>

#include "materials/patterns/footprint.h"

namespace kelpie {

/// Of a pattern at one moment: how much of space has values below a value, and the value below which so much of space has them. From
/// random places; the same on every machine.
class ValueDistribution {
public:
  template <class SampledPattern>
  explicit ValueDistribution(const SampledPattern& pattern) : values_(k_count) {
    std::minstd_rand random(1);
    const float reach = std::min(50 * pattern.size, 1e6f);
    const auto coordinate = [&] { return reach * (2 * float(random()) / float(random.max()) - 1); };
    for (float& value : values_) {
      const float x = coordinate(), y = coordinate(), z = coordinate();
      value = pattern.value(Vec3(x, y, z), Footprint{});
    }
    std::sort(values_.begin(), values_.end());
    values_.front() = 0, values_.back() = 1; // there is nothing beyond, whatever the places met
  }

  float value_at(float share) const {
    const float place = std::clamp(share, 0.f, 1.f) * float(k_count - 1);
    const size_t i = std::min(size_t(place), k_count - 2);
    return values_[i] + (values_[i + 1] - values_[i]) * (place - float(i));
  }
  /// In the middle of those of one value, where much of space has it.
  float share_below(float value) const {
    const auto [first, last] = std::equal_range(values_.begin(), values_.end(), value);
    if (first != last) return 0.5f * float((first - values_.begin()) + (last - values_.begin()) - 1) / float(k_count - 1);
    if (first == values_.begin() || first == values_.end()) return first == values_.begin() ? 0.f : 1.f;
    const float before = *(first - 1);
    return (float(first - values_.begin()) - 1 + (value - before) / (*first - before)) / float(k_count - 1);
  }

private:
  static constexpr size_t k_count = 4096;
  std::vector<float> values_;
};

} // namespace kelpie
