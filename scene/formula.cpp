#include "scene/formula.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <set>
#include <span>

#include <fmt/format.h>

#include "scene/value_reader.h"

namespace kelpie {

namespace {

/// Between two frames at which a function has values that are far apart: where it jumps.
double jump_between(const Formula& formula, double from, double to) {
  constexpr int k_halvings = 20;
  float low = formula.at(from), high = formula.at(to);
  for (int i = 0; i < k_halvings; ++i) {
    const double middle = 0.5 * (from + to);
    const float v = formula.at(middle);
    if (std::abs(v - low) < std::abs(high - v))
      from = middle, low = v;
    else
      to = middle, high = v;
  }
  return to;
}

std::span<const float> components(const float& v) { return {&v, 1}; }
std::span<const float> components(const Vec3& v) { return {&v.x, 3}; }
std::span<const float> components(const Colour& c) { return components(c.rgb); }

} // namespace

Formula::Formula(Expression expression, std::vector<double> frames) : expression_(std::move(expression)), frames_(std::move(frames)) {
  static std::atomic<uint64_t> count{0};
  number_ = ++count;
}

float Formula::at(double frame) const {
  struct Known {
    uint64_t formula = 0; // none
    double frame = 0;
    float value = 0;
  };
  constexpr size_t k_count = 1 << 14;
  thread_local std::vector<Known> all(k_count);
  Known& known = all[(number_ * 0x9e3779b97f4a7c15u ^ std::bit_cast<uint64_t>(frame) * 0xd6e8feb86659fd93u) >> 50];
  if (known.formula == number_ && known.frame == frame) return known.value;
  const auto value = static_cast<float>(expression_.at(frame)); // asks other formulas, which may want the same place
  known = {number_, frame, value};
  return value;
}

std::vector<double> Formula::breaks(double from, double to) const {
  const std::scoped_lock lock(breaks_mutex_);
  if (!last_breaks_ || last_breaks_->from != from || last_breaks_->to != to) last_breaks_ = Breaks{from, to, found_breaks(from, to)};
  return last_breaks_->frames;
}

std::vector<double> Formula::found_breaks(double from, double to) const {
  constexpr int k_steps = 64;
  constexpr float k_bend = 0.5f; // of the largest step: a smooth wave has that only if a dozen of them are in the stretch
  constexpr float k_leap = 8;    // times the steps beside it
  const auto frame_of = [&](int i) { return from + (to - from) * i / k_steps; };
  constexpr float k_rounding = 1e-5f; // of the value: less than this is no step
  std::array<float, k_steps> steps{};
  float largest = 0, before = at(from);
  for (int i = 0; i < k_steps; ++i) {
    const float v = at(frame_of(i + 1));
    if (std::abs(v - before) > k_rounding * std::abs(v)) steps[i] = v - before;
    before = v;
    largest = std::max(largest, std::abs(steps[i]));
  }
  std::set<double> breaks;
  for (int i = 1; i < k_steps; ++i)
    if (steps[i - 1] * steps[i] < 0 || std::abs(steps[i] - steps[i - 1]) > k_bend * largest) breaks.insert(frame_of(i));
  for (int i = 0; i < k_steps; ++i) {
    const float beside = std::max(i > 0 ? std::abs(steps[i - 1]) : 0, i + 1 < k_steps ? std::abs(steps[i + 1]) : 0);
    if (std::abs(steps[i]) > k_leap * beside) breaks.insert(jump_between(*this, frame_of(i), frame_of(i + 1)));
  }
  return {breaks.begin(), breaks.end()};
}

template <class T>
T Checked<T>::at(double frame) const {
  const T value = function_->at(frame);
  bool is_zero = true;
  for (const float v : components(value)) {
    if (!std::isfinite(v))
      throw Error(ExitStatus::bad_data, fmt::format("{}: the {} has no value at frame {:.6g}", rules_.name, what_, frame), where_);
    if (!rules_.range.contains(double(v)))
      throw Error(ExitStatus::bad_data,
                  fmt::format("{} must be {}: the {} is {:.6g} at frame {:.6g}", rules_.name, describe(rules_.range), what_, v, frame),
                  where_);
    is_zero &= v == 0;
  }
  if (rules_.is_nonzero && is_zero)
    throw Error(ExitStatus::bad_data, fmt::format("{} may not be zero: the {} is at frame {:.6g}", rules_.name, what_, frame), where_);
  return value;
}

template class Checked<float>;
template class Checked<Vec3>;
template class Checked<Colour>;

} // namespace kelpie
