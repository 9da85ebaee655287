// How much of each stop of a pattern there is where its phase is spread.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

namespace kelpie {

/// The phases that a pattern has: values repeat with period 1, or there is an interval beyond which they no longer change.
struct PhaseDomain {
  float lower = 0, upper = 1;
  bool is_periodic = true;
};

/// The means of a function of the phase, and of the shares of the stops at its values, for phases that are normally distributed.
///
/// A pyramid: each level has half the entries of the one before, smoothed by (1 3 3 1) / 8, and between levels the variance is linear,
/// so that variances are exact, the mean over the whole domain is the same on all levels, and nothing here needs more than IEEE
/// arithmetic. (Rejected: differences of integrals, boxes: beyond a period they leave a ripple of 1 / width.)
class ShareTable {
public:
  /// Of `profile`, phase to value in [0, 1], and stops at the values `at`, ascending.
  template <class Profile>
  ShareTable(const PhaseDomain& domain, std::span<const float> at, const Profile& profile)
      : domain_(domain), stops_(std::max<size_t>(at.size(), 1)), columns_(stops_ + 1) {
    std::vector<float> row(columns_);
    for (size_t i = 0; i < k_entries; ++i) {
      std::fill(row.begin(), row.end(), 0.f);
      for (size_t k = 0; k < k_samples; ++k) {
        const float place = (static_cast<float>(i) + (static_cast<float>(k) + 0.5f) / k_samples) / k_entries;
        add_stops(profile(domain.lower + place * (domain.upper - domain.lower)), at, row);
      }
      for (const float sum : row) entries_.push_back(sum / k_samples);
    }
    for (size_t size = k_entries; size > 1; size /= 2) add_level(size);
  }

  size_t stop_count() const { return stops_; }

  /// The mean value where the phase has this mean and variance.
  float value(float phase, float variance) const {
    float result = 0;
    visit(phase, variance, [&](const float* row, float weight) { result += weight * row[0]; });
    return result;
  }
  /// Adds weight * the mean shares.
  void add_shares(float phase, float variance, float weight, std::span<float> shares) const {
    visit(phase, variance, [&](const float* row, float w) {
      for (size_t s = 0; s < stops_; ++s) shares[s] += weight * w * row[s + 1];
    });
  }

private:
  static constexpr size_t k_entries = 512, k_samples = 4;
  static constexpr int k_last_level = 9;

  /// Value and shares of one value: hats between neighbouring stops, steps where two are at one place.
  void add_stops(float value, std::span<const float> at, std::vector<float>& row) const {
    row[0] += value;
    float above = 1; // how much lies beyond the stops so far
    for (size_t s = 0; s < stops_; ++s) {
      float beyond = 0;
      if (s + 1 < at.size()) {
        const float width = at[s + 1] - at[s];
        beyond = std::min(above, width > 0 ? std::clamp((value - at[s]) / width, 0.f, 1.f) : static_cast<float>(value >= at[s]));
      }
      row[s + 1] += above - beyond;
      above = beyond;
    }
  }

  void add_level(size_t size) {
    const size_t from = entries_.size() - size * columns_;
    for (size_t i = 0; i < size; i += 2) {
      const auto row = [&](size_t entry, size_t forward) { // `entry` + `forward` - 1, about the ends
        const size_t wanted =
            domain_.is_periodic ? (entry + forward + size - 1) % size : std::min(std::max<size_t>(entry + forward, 1) - 1, size - 1);
        return from + wanted * columns_;
      };
      for (size_t c = 0; c < columns_; ++c)
        entries_.push_back((entries_[row(i, 0) + c] + 3 * entries_[row(i, 1) + c] + 3 * entries_[row(i, 2) + c] + entries_[row(i, 3) + c]) /
                           8);
    }
  }

  /// Calls use(row, weight) for the four entries whose weighted sum is the mean.
  template <class Use>
  void visit(float phase, float variance, const Use& use) const {
    // Level l has the variance (4^l - 1) / 4 of entries squared.
    const float entry = k_entries / (domain_.upper - domain_.lower);
    const float scaled = std::min(4 * variance * entry * entry + 1, 0x1p18f);
    int level = 0;
    float least = 1; // 4^level
    for (; level < k_last_level - 1 && scaled >= 4 * least; least *= 4) ++level;
    const float second = (scaled - least) / (3 * least);
    visit_level(phase, level, 1 - second, use);
    if (second > 0) visit_level(phase, level + 1, second, use);
  }
  template <class Use>
  void visit_level(float phase, int level, float weight, const Use& use) const {
    const int size = static_cast<int>(k_entries) >> level;
    float place = (phase - domain_.lower) / (domain_.upper - domain_.lower);
    place = domain_.is_periodic ? place - std::floor(place) : std::clamp(place, 0.f, 1.f);
    place = place * static_cast<float>(size) + 0.5f; // entry i is at i + 1/2; counted from -1
    const int whole = static_cast<int>(place);
    const float fraction = place - static_cast<float>(whole);
    const auto row = [&](int i) {
      i = domain_.is_periodic ? (i + size) % size : std::clamp(i, 0, size - 1);
      const size_t skipped = 2 * (k_entries - static_cast<size_t>(size)); // all finer levels
      return entries_.data() + (skipped + static_cast<size_t>(i)) * columns_;
    };
    use(row(whole - 1), weight * (1 - fraction));
    use(row(whole), weight * fraction);
  }

  PhaseDomain domain_;
  size_t stops_, columns_; ///< a row: the value, then the share of each stop
  std::vector<float> entries_;
};

} // namespace kelpie
