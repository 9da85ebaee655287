#pragma once

#include "materials/patterns/cellular.h"

namespace kelpie {

template <class Mode>
struct Cells : SolidTexture<Cells, Mode> {
  static constexpr std::string_view k_name = "cells";
  static constexpr std::string_view k_doc = R"(Cells, each of a tone of its own, as of a mosaic or of cracked ice.

    phase   = a random number for every one of Worley's cells of p / size + turbulence * noise(p)
    profile = the phase

All values are as frequent.)";
  static constexpr std::array<PlainStop, 4> k_default_stops{{{0.f, 0.03f, 0.1f, 0.14f, 0.25f},
                                                             {0.35f, 0.06f, 0.26f, 0.27f, 0.25f},
                                                             {0.65f, 0.25f, 0.46f, 0.38f, 0.25f},
                                                             {1.f, 0.7f, 0.66f, 0.48f, 0.25f}}};
  static constexpr PhaseDomain k_domain{0, 1, false};

  Cells() : SolidTexture<Cells, Mode>({.size = 0.3f}) {}

  static constexpr auto parameters() { return Cells::common_parameters(); }

  // Sampled:
  PhaseMixture mixture(const Place& straight) const {
    const float lost = cells_unseen(straight);
    if (lost == 1) return k_all_phases;
    const TwoCells cells(this->turbulent(straight).turned(), this->stream(2));
    PhaseMixture mixture(SpreadPhase{unit_of(cells.cell.first.id)});
    mixture.cover({unit_of(cells.cell.second.id)}, 1 - cells.part);
    mixture.cover(k_all_phases, lost);
    return mixture;
  }

  float profile(float phase) const { return phase; }
};

} // namespace kelpie
