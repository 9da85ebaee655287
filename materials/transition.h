#pragma once

#include <array>
#include <memory>
#include <optional>

#include "base/kind.h"
#include "materials/patterns/share_table.h"
#include "materials/patterns/value_distribution.h"

namespace kelpie {

/// How one material becomes another.
enum class TransitionWay { automatic, phase, growth, dissolve };

template <>
struct EnumNames<TransitionWay> {
  static constexpr std::array<std::pair<std::string_view, TransitionWay>, 4> values{{{"automatic", TransitionWay::automatic},
                                                                                     {"phase", TransitionWay::phase},
                                                                                     {"growth", TransitionWay::growth},
                                                                                     {"dissolve", TransitionWay::dissolve}}};
};

/// A pattern over a period of its phase, at phases that are equally far apart.
struct PhaseRanks {
  std::vector<float> darker; ///< of each phase, how many of all are darker, in [0, 1]
  std::vector<float> values; ///< of all phases, from the darkest one on
  std::vector<float> stops;  ///< where they are
};

/// What is known of both sides before anything is sampled.
struct TransitionTables {
  std::optional<ValueDistribution> from, to; ///< for growth; none of what is no pattern
  bool is_opposed = false;                   ///< whether high values are light on one side and dark on the other
  std::array<PhaseRanks, 2> ranks;           ///< for phases
};

/// How much there is of the stops of both sides at a blended phase.
struct BlendedPhases {
  ShareTable from, to;
};

template <class Mode>
struct Transition;

std::shared_ptr<const BlendedPhases> blended_phases(const Transition<SampledMode>&);

/// What is wrong with a transition: it asks for a way that its materials cannot go.
std::optional<ParameterProblem> problem_of(const Transition<AnimatedMode>&);

template <class Mode>
struct Transition {
  static constexpr std::string_view k_name = "transition";
  static constexpr std::string_view k_doc = R"(One material on its way to another: all of `from` at progress 0, all of `to` at 1.

A mixture of two patterns shows both at once, and pale. So `way` is
    phase      where values repeat with a phase on both sides (marble, wood, strata, stripes): veins swing round and become rings.
                   phase = (1 - progress) phase of `from` + progress (phase of `to` - shift); over a period of it light and dark change
                   evenly from where they are in the one to where they are in the other
    growth     of other patterns: `to` comes through `from` in patches, first where its own values are highest, and colours
               change evenly as it grows. So it is between a pattern and a plain surface, but that both keep their colours.
    dissolve   of two plain surfaces; for any it is the mixture
unless something else is said.
Source: ours; methods.md section 5.)";

  typename Mode::Material from{}, to{};
  Value<Mode, float> progress{0.5f};
  TransitionWay way = TransitionWay::automatic;
  std::optional<Value<Mode, float>> shift{}, patch_size{};
  std::shared_ptr<const TransitionTables> tables{}; ///< by complete_transition()
  std::shared_ptr<const BlendedPhases> blended{};   ///< by prepare()

  static constexpr auto parameters() {
    return std::tuple{
        parameter("from", &Transition::from, "the material at progress 0").or_named_in("materials").required(),
        parameter("to", &Transition::to, "the material at progress 1").or_named_in("materials").required(),
        parameter("progress", &Transition::progress, "how far it is on its way").at_least(0).at_most(1),
        parameter("way", &Transition::way, "how it goes"),
        parameter("shift", &Transition::shift,
                  "of the phase of `to`, in periods; unless it is said, where the light and the dark of both agree best"),
        parameter("patch_size", &Transition::patch_size,
                  "of the patches that grow; unless it is said, 5 times the size of the larger pattern")
            .in(Unit::length)
            .above(0),
    };
  }
  static constexpr auto assets() { return std::tuple{&Transition::tables}; }

  void prepare() requires std::is_same_v<Mode, SampledMode> {
    if (way == TransitionWay::phase && tables) blended = blended_phases(*this);
  }
  std::optional<ParameterProblem> problem() const requires std::is_same_v<Mode, AnimatedMode> { return problem_of(*this); }
};

/// Chooses whatever was not said, as the materials are at `frame`; to be called where problem() finds nothing.
void complete_transition(Transition<AnimatedMode>&, double frame);

} // namespace kelpie
