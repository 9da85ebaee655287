// A transition at a point.
#include "materials/add_stops.h"

namespace kelpie {

namespace {

/// Where a transition is looked at, and the mix that it adds to.
template <class Mix>
class Spot {
public:
  Spot(const SampledMaterials& all, const Vec3& p, const Footprint& footprint, Mix& mix)
      : all_(all), p_(p), footprint_(footprint), mix_(mix) {}

  Place place() const { return {p_, footprint_}; }

  /// What patterns have here.
  PhaseMixture phases_of(MaterialIndex pattern) const {
    PhaseMixture phases(k_all_phases);
    visit(pattern, [&](const auto& kind) { phases = kind.phases(p_, footprint_); });
    return phases;
  }
  float value_of(MaterialIndex pattern) const {
    float value = 0;
    visit(pattern, [&](const auto& kind) { value = kind.value(p_, footprint_); });
    return value;
  }

  /// 0 where the features of a pattern are far larger than the footprint, 1 where they are smaller.
  float fineness_of(MaterialIndex pattern) const {
    float fineness = 0;
    visit(pattern, [&](const auto& kind) { fineness = std::min(1.f, place().scaled(1 / kind.size).width()); });
    return fineness;
  }

  void add(MaterialIndex material, float weight) const {
    if (weight > 0) add_material(all_, material, p_, footprint_, weight, mix_);
  }
  /// A pattern as it is at other phases, or at another value, than it has here.
  template <class Phases>
  void add_at(MaterialIndex pattern, const Phases& phases, float weight) const {
    visit(pattern, [&](const auto& kind) {
      add_shares_of(
          kind, [&](std::span<float> shares) { kind.shares(phases, shares); }, weight);
    });
  }
  /// As much of a pattern's stops as `shares_of` says.
  template <class SharesOf>
  void add_shares(MaterialIndex pattern, const SharesOf& shares_of, float weight) const {
    visit(pattern, [&](const auto& kind) { add_shares_of(kind, shares_of, weight); });
  }

private:
  template <class Visit>
  void visit(MaterialIndex pattern, const Visit& visit) const {
    std::visit(
        [&]<class Kind>(const Kind& kind) {
          if constexpr (Pattern<Kind>) visit(kind);
        },
        all_[pattern.index]);
  }
  template <class Kind, class SharesOf>
  void add_shares_of(const Kind& kind, const SharesOf& shares_of, float weight) const {
    if (weight > 0) add_stops(all_, kind, shares_of, p_, footprint_, weight, mix_);
  }

  const SampledMaterials& all_;
  const Vec3& p_;
  const Footprint& footprint_;
  Mix& mix_;
};

/// What covers the veins of a pattern, or is drawn over its rings, stays with the pattern that has it.
template <class Mix>
void add_phases(const Spot<Mix>& spot, const Transition<SampledMode>& t, float s, float weight) {
  const PhaseMixture from = spot.phases_of(t.from), to = spot.phases_of(t.to);
  const SpreadPhase &a = from.phases[0], &b = to.phases[0];
  SpreadPhase blended{(1 - s) * a.mean + s * (b.mean - t.shift.value_or(0.f)),
                      (1 - s) * (1 - s) * a.variance + s * s * b.variance}; // as if the one did not know of the other
  const auto add_side = [&](MaterialIndex pattern, const PhaseMixture& own, const ShareTable& table, float side_weight) {
    spot.add_at(pattern, own.without_first(), side_weight);
    blended.weight = own.phases[0].weight;
    spot.add_shares(
        pattern,
        [&](std::span<float> shares) {
          std::fill(shares.begin(), shares.end(), 0.f);
          table.add_shares(blended.mean, blended.variance, blended.weight, shares);
        },
        side_weight);
  };
  add_side(t.from, from, t.blended->from, weight * (1 - s));
  add_side(t.to, to, t.blended->to, weight * s);
}

constexpr float k_patchiness = 0.9f; ///< how much patches count, beside the features of the pattern
constexpr float k_border = 0.06f;    ///< half of it, in shares of space

/// How much of all values u + k_patchiness v is below x, for u and v in [0, 1].
float share_of_sums_below(float x) {
  constexpr float k = k_patchiness;
  if (x < k) return x * x / (2 * k);
  if (x < 1) return x - k / 2;
  return 1 - (1 + k - x) * (1 + k - x) / (2 * k);
}

/// How much of a place is already `to`: `late` is its place in the order of growth, in [0, 1], of a pattern that is so fine.
float grown_part(const Place& seen_at, float late, float fineness, float patch_size, float s) {
  const Place place = seen_at.scaled(1 / patch_size);
  const float patches = normal_below(place.noise({.octaves = 2, .seed = 0x7a7c4}).value);
  const float order = glm::mix(share_of_sums_below(late + k_patchiness * patches), patches, fineness); // from afar all is as late
  const float border = glm::mix(k_border, 1.f, std::min(1.f, place.width())); // what is finer than a pixel is its mean
  const float x = std::clamp((s * (1 + 2 * border) - border - order) / (2 * border) + 0.5f, 0.f, 1.f);
  return x * x * (3 - 2 * x);
}

/// Both sides have the colours that are between theirs: where so much of space has lower values, or higher ones.
template <class Mix>
void add_growth(const Spot<Mix>& spot, const Transition<SampledMode>& t, float s, float weight) {
  const auto &from = t.tables->from, &to = t.tables->to;
  const float value_from = from ? spot.value_of(t.from) : 0, value_to = to ? spot.value_of(t.to) : 0;
  const float share_from = from ? from->share_below(value_from) : 0, share_to = to ? to->share_below(value_to) : 0;
  const float fine_from = from ? spot.fineness_of(t.from) : 0, fine_to = to ? spot.fineness_of(t.to) : 0;
  const float part = grown_part(spot.place(), to ? 1 - share_to : share_from, to ? fine_to : fine_from, t.patch_size.value_or(1.f), s);
  if (!from || !to) {
    spot.add(t.from, weight * (1 - part));
    spot.add(t.to, weight * part);
    return;
  }
  const auto other_side = [&](float share) { return t.tables->is_opposed ? 1 - share : share; };
  const auto add_other = [&](MaterialIndex pattern, float value, float fineness, float w) {
    spot.add_at(pattern, value, w * (1 - fineness));
    spot.add(pattern, w * fineness); // what is finer than a pixel is its mean
  };
  spot.add(t.from, weight * (1 - part) * (1 - s));
  add_other(t.to, to->value_at(other_side(share_from)), fine_from, weight * (1 - part) * s);
  add_other(t.from, from->value_at(other_side(share_to)), fine_to, weight * part * (1 - s));
  spot.add(t.to, weight * part * s);
}

} // namespace

template <class Mix>
void add_transition(const SampledMaterials& all, const Transition<SampledMode>& t, const Vec3& p, const Footprint& footprint, float weight,
                    Mix& mix) {
  const float s = t.progress;
  const Spot<Mix> spot(all, p, footprint, mix);
  if (s <= 0 || s >= 1) return spot.add(s <= 0 ? t.from : t.to, weight);
  if (t.way == TransitionWay::phase) return add_phases(spot, t, s, weight);
  if (t.way == TransitionWay::growth) return add_growth(spot, t, s, weight);
  spot.add(t.from, weight * (1 - s));
  spot.add(t.to, weight * s);
}

template void add_transition(const SampledMaterials&, const Transition<SampledMode>&, const Vec3&, const Footprint&, float, SurfaceMix&);
template void add_transition(const SampledMaterials&, const Transition<SampledMode>&, const Vec3&, const Footprint&, float, HeightMix&);

} // namespace kelpie
