#pragma once

#include <optional>

#include "base/kind.h"

namespace kelpie {

/// What is wrong with two materials whose phases are to be blended; nothing if both are patterns of which values repeat with a phase.
std::optional<ParameterProblem> problem_of_phases(const AnimatedMode::Material& from, const AnimatedMode::Material& to);

template <class Mode>
struct PhaseBlend {
  static constexpr std::string_view k_name = "phase_blend";
  static constexpr std::string_view k_doc = R"(One pattern on its way to another: veins swing round and become rings.

    phase    = (1 - progress) phase of `from` + progress (phase of `to` - shift)
    material = (1 - progress) `from` at phase + progress `to` at phase + shift

Both are patterns whose values repeat with a phase: marble, wood, strata, stripes. At progress 0 and 1 it is the one and the other; on
the way there is one pattern with the contrast of both, where a plain mixture shows both at once, and pale.
Source: ours; methods.md section 5, phase.)";

  typename Mode::Material from{}, to{};
  Value<Mode, float> progress{0.5f};
  std::optional<Value<Mode, float>> shift{};

  static constexpr auto parameters() {
    return std::tuple{
        parameter("from", &PhaseBlend::from, "the pattern at progress 0").or_named_in("materials").required(),
        parameter("to", &PhaseBlend::to, "the pattern at progress 1").or_named_in("materials").required(),
        parameter("progress", &PhaseBlend::progress, "how far it is on its way").at_least(0).at_most(1),
        parameter("shift", &PhaseBlend::shift, "of the phase of `to`, in periods; unless it is said, the one at which both are most alike"),
    };
  }

  std::optional<ParameterProblem> problem() const requires std::is_same_v<Mode, AnimatedMode> { return problem_of_phases(from, to); }
};

/// At which shift the light and dark of two patterns of phases go best together, as they are at `frame`, in [0, 1).
float best_phase_shift(const AnimatedMode::Material& from, const AnimatedMode::Material& to, double frame);

} // namespace kelpie
