// Values that change over time: {"keys": [[frame, value, derivative…], …], "interpolation": …}.
#include <cmath>
#include <span>

#include "scene/value_reader.h"

namespace kelpie {

namespace {

constexpr std::string_view k_key_form = "[frame, value] or [frame, value, derivative, …]";
/// A curve of a higher degree than 2 * 5 - 1 swings more than it helps.
constexpr size_t k_most_derivatives = 4;
/// Of two keys, in frames: what repeats more often cannot be counted.
constexpr double k_least_step = 1e-6;

/// Far beyond any film, and differences of frames stay finite.
ParameterRules frame_rules() {
  ParameterRules rules{"frame", {}};
  rules.range = {-1e9, 1e9};
  return rules;
}

bool is_within(const Range& range, float v) { return range.contains(double(v)); }
bool is_within(const Range& range, const Vec3& v) { return is_within(range, v.x) && is_within(range, v.y) && is_within(range, v.z); }
bool is_within(const Range& range, const Colour& c) { return is_within(range, c.rgb); }

/// Whether a curve goes to where none of its keys is.
bool may_leave_keys(const Ends& ends) {
  const auto leaves = [](Outside how) { return how == Outside::proceed || how == Outside::cycle_offset; };
  return leaves(ends.before) || leaves(ends.after);
}

bool have_equal_signs(float a, float b) { return (a < 0) == (b < 0); }
bool have_equal_signs(const Vec3& a, const Vec3& b) {
  return have_equal_signs(a.x, b.x) && have_equal_signs(a.y, b.y) && have_equal_signs(a.z, b.z);
}
bool have_equal_signs(const Colour& a, const Colour& b) { return have_equal_signs(a.rgb, b.rgb); }

} // namespace

template <class T>
bool ValueReader::read_key(Key<T>& out, const JsonValue& v, Interpolation how, const ParameterRules& rules) {
  const JsonValue::Array* parts = v.array();
  if (!parts) return fail_type(v, rules.name, k_key_form);
  if (parts->size() < 2) return fail(v, fmt::format("{}: expected {}, found {}", rules.name, k_key_form, count_of_values(parts->size())));
  const bool has_frame = read(out.frame, (*parts)[0], frame_rules());
  bool is_good = read(out.value, (*parts)[1], rules) && has_frame;
  if (parts->size() == 2) return is_good;
  if (how != Interpolation::hermite)
    return fail((*parts)[2], fmt::format("{}: derivatives need \"interpolation\": \"hermite\"", rules.name));
  const auto read_derivatives = [&](std::vector<T>& to, std::span<const JsonValue> from) {
    if (from.size() > k_most_derivatives) return fail(v, fmt::format("{}: more than {} derivatives", rules.name, k_most_derivatives));
    bool is_read = true;
    for (const JsonValue& number : from) {
      // Slopes have no range, and those of colours are scene-linear: a curved space has no derivative of its own.
      if constexpr (std::is_same_v<T, Colour>)
        is_read &= read_triple(to.emplace_back().rgb, number, rules.name, "[r, g, b]");
      else
        is_read &= read(to.emplace_back(), number, ParameterRules{rules.name, {}});
    }
    return is_read;
  };
  const JsonValue& sides = (*parts)[2];
  if (!sides.object()) return read_derivatives(out.derivatives, std::span(*parts).subspan(2)) && is_good;
  constexpr std::array<std::string_view, 2> k_sides{"before", "after"};
  if (parts->size() > 3) return fail((*parts)[3], fmt::format("{}: nothing follows the derivatives of both sides", rules.name));
  is_good &= check_only(sides, k_sides);
  const auto read_side = [&](std::vector<T>& to, std::string_view name) {
    const JsonValue* side = sides.find(name);
    if (!side) return true;
    return side->array() ? read_derivatives(to, *side->array()) : fail_type(*side, name, "a list of derivatives");
  };
  is_good &= read_side(out.derivatives_before.emplace(), "before");
  return read_side(out.derivatives, "after") && is_good;
}

/// A Hermite curve or a spline can leave the range in which its keys lie, and any that does not step passes what lies between two keys.
/// Sampled, not solved: what slips through is less than an eighth of an interval wide.
template <class T>
bool ValueReader::check_between_keys(const Curve<T>& curve, const JsonValue& v, const ParameterRules& rules) {
  if (curve.interpolation() == Interpolation::step) return true;
  constexpr int k_samples = 8;
  for (size_t i = 1; i < curve.keys().size(); ++i)
    for (int j = 1; j <= k_samples; ++j) {
      const double from = curve.keys()[i - 1].frame, to = curve.keys()[i].frame;
      const double frame = from + (to - from) * j / k_samples;
      const bool passes_zero = rules.range.without_zero && !have_equal_signs(curve.keys()[i - 1].value, curve.at(frame));
      if (passes_zero || !is_within(rules.range, curve.at(frame)))
        return fail(v, fmt::format("{} must be {}: the curve leaves that between its keys, at frame {:.6g}", rules.name,
                                   describe(rules.range), frame));
    }
  return true;
}

template <class T>
bool ValueReader::read_curve(Animated<T>& out, const JsonValue& v, const ParameterRules& rules) {
  constexpr std::array<std::string_view, 4> k_keys{"keys", "interpolation", "before", "after"};
  bool is_good = check_only(v, k_keys);
  const auto read_mode = [&](auto& mode, std::string_view key) {
    if (const JsonValue* name = v.find(key)) is_good &= read_enum(mode, *name, ParameterRules{key, {}});
  };
  Interpolation how = Interpolation::linear;
  Ends ends;
  read_mode(how, "interpolation"), read_mode(ends.before, "before"), read_mode(ends.after, "after");

  const JsonValue* list = v.find("keys");
  if (!list) return fail(v, fmt::format("{}: missing key \"keys\"", rules.name));
  if (!list->array()) return fail_type(*list, "keys", "a list");
  if (list->array()->empty()) return fail(*list, "keys may not be empty");
  std::vector<Key<T>> keys(list->array()->size());
  const Key<T>* previous = nullptr; // none behind a faulty key: nothing is said about the order there
  for (size_t i = 0; i < keys.size(); ++i) {
    const JsonValue& key = (*list->array())[i];
    const bool is_good_key = read_key(keys[i], key, how, rules);
    if (is_good_key && previous && !(keys[i].frame > previous->frame))
      is_good = fail(key, fmt::format("keys must ascend: frame {} follows frame {}", keys[i].frame, previous->frame));
    else if (is_good_key && previous && keys[i].frame - previous->frame < k_least_step)
      is_good = fail(key, fmt::format("two keys are less than {} of a frame apart", k_least_step));
    is_good &= is_good_key;
    previous = is_good_key ? &keys[i] : nullptr;
  }
  if (!is_good) return false;
  const auto curve = std::make_shared<Curve<T>>(std::move(keys), how, ends);
  if (!check_between_keys(*curve, v, rules)) return false;
  const bool is_constant = curve->keys().size() == 1;
  if (!is_constant && may_leave_keys(ends)) return use_checked<T>(out, curve, "curve", v, rules);
  out = is_constant ? Animated<T>(curve->keys().front().value) : Animated<T>(curve);
  return true;
}

template bool ValueReader::read_curve(Animated<float>&, const JsonValue&, const ParameterRules&);
template bool ValueReader::read_curve(Animated<Vec3>&, const JsonValue&, const ParameterRules&);
template bool ValueReader::read_curve(Animated<Colour>&, const JsonValue&, const ParameterRules&);

} // namespace kelpie
