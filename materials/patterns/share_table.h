// How much of each stop of a pattern there is where its phase is spread.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
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
/// A pyramid: each level is smoother than the one before, by about a factor of two in variance, and every second has half the entries.
/// Smoothing mirrors at the ends of an interval, so that the mean over the whole domain is the same on all levels. Between levels the
/// result is linear in the variance. Nothing here needs more than IEEE arithmetic. (Rejected: differences of integrals, which are
/// boxes: beyond a period they leave a ripple of 1 / width.)
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
    levels_.push_back({0, k_entries, k_interpolated});
    while (levels_.back().size > 1) {
      add_smoothed(levels_.back(), 3);
      add_halved(levels_.back());
    }
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
  static constexpr float k_interpolated = 1 / 6.f; ///< the mean variance that linear interpolation adds, in squared steps

  struct Level {
    size_t first, size; ///< rows
    float variance;     ///< by which it is smoothed, in squared steps of the finest
  };

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

  /// Where the row at `place` of a level is, which may be beyond its ends.
  size_t row(const Level& level, ptrdiff_t place) const {
    const auto size = static_cast<ptrdiff_t>(level.size);
    const ptrdiff_t wanted = domain_.is_periodic ? (place + size) % size : std::clamp<ptrdiff_t>(place, 0, size - 1);
    return (level.first + static_cast<size_t>(wanted)) * columns_;
  }
  size_t row_count() const { return entries_.size() / columns_; }

  /// A level with as many entries, smoothed by (1 2 1) / 4 so many times.
  void add_smoothed(const Level& from, int passes) {
    const float step = static_cast<float>(k_entries / from.size);
    const Level level{row_count(), from.size, from.variance + 0.5f * static_cast<float>(passes) * step * step};
    entries_.insert(entries_.end(), entries_.begin() + static_cast<ptrdiff_t>(from.first * columns_),
                    entries_.begin() + static_cast<ptrdiff_t>((from.first + from.size) * columns_));
    smooth(level, passes);
    levels_.push_back(level);
  }
  /// A level with half the entries, smoothed by (1 3 3 1) / 8, and then by (1 2 1) / 4.
  void add_halved(const Level& from) {
    const float step = static_cast<float>(k_entries / from.size);
    const Level level{row_count(), from.size / 2, from.variance + (0.75f + 4 * (0.5f + k_interpolated) - k_interpolated) * step * step};
    for (ptrdiff_t i = 0; i < static_cast<ptrdiff_t>(from.size); i += 2)
      for (size_t c = 0; c < columns_; ++c)
        entries_.push_back((entries_[row(from, i - 1) + c] + 3 * entries_[row(from, i) + c] + 3 * entries_[row(from, i + 1) + c] +
                            entries_[row(from, i + 2) + c]) /
                           8);
    smooth(level, 1);
    levels_.push_back(level);
  }
  /// Smooths the last level.
  void smooth(const Level& level, int passes) {
    const size_t begin = level.first * columns_;
    for (; passes > 0; --passes) {
      const std::vector<float> before(entries_.begin() + static_cast<ptrdiff_t>(begin), entries_.end());
      for (ptrdiff_t i = 0; i < static_cast<ptrdiff_t>(level.size); ++i) {
        const float *left = before.data() + row(level, i - 1) - begin, *here = before.data() + row(level, i) - begin;
        const float* right = before.data() + row(level, i + 1) - begin;
        for (size_t c = 0; c < columns_; ++c) entries_[row(level, i) + c] = (left[c] + 2 * here[c] + right[c]) / 4;
      }
    }
  }

  /// Calls use(row, weight) for the four entries whose weighted sum is the mean.
  template <class Use>
  void visit(float phase, float variance, const Use& use) const {
    const float steps = k_entries / (domain_.upper - domain_.lower), wanted = variance * steps * steps;
    size_t next = 1;
    while (next + 1 < levels_.size() && levels_[next].variance < wanted) ++next;
    const Level &sharp = levels_[next - 1], &smooth = levels_[next];
    const float weight = std::clamp((wanted - sharp.variance) / (smooth.variance - sharp.variance), 0.f, 1.f);
    if (weight < 1) visit_level(phase, sharp, 1 - weight, use);
    if (weight > 0) visit_level(phase, smooth, weight, use);
  }
  template <class Use>
  void visit_level(float phase, const Level& level, float weight, const Use& use) const {
    float place = (phase - domain_.lower) / (domain_.upper - domain_.lower);
    place = domain_.is_periodic ? place - std::floor(place) : std::clamp(place, 0.f, 1.f);
    place = place * static_cast<float>(level.size) + 0.5f; // entry i is at i + 1/2; counted from -1
    const auto whole = static_cast<ptrdiff_t>(place);
    const float fraction = place - static_cast<float>(whole);
    use(entries_.data() + row(level, whole - 1), weight * (1 - fraction));
    use(entries_.data() + row(level, whole), weight * fraction);
  }

  PhaseDomain domain_;
  size_t stops_, columns_; ///< a row: the value, then the share of each stop
  std::vector<float> entries_;
  std::vector<Level> levels_;
};

} // namespace kelpie
