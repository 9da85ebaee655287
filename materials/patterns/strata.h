#pragma once

#include "materials/patterns/solid_texture.h"

namespace kelpie {

template <class Mode>
struct Strata : SolidTexture<Strata, Mode> {
  static constexpr std::string_view k_name = "strata";
  static constexpr std::string_view k_doc = R"(Layers of sediment, of many thicknesses and tones.

    phase   = (direction . p / size + turbulence * noise(p / (size * turbulence_size))) / 16
    profile: sixteen layers, each of a random tone, darker towards its ground; then they repeat

`size` is the mean thickness of a layer.)";
  static constexpr std::array<PlainStop, 5> k_default_stops{{{0.f, 0.13f, 0.052f, 0.03f, 0.75f},
                                                             {0.3f, 0.3f, 0.135f, 0.07f, 0.75f},
                                                             {0.55f, 0.43f, 0.25f, 0.14f, 0.75f},
                                                             {0.8f, 0.52f, 0.38f, 0.25f, 0.75f},
                                                             {1.f, 0.6f, 0.5f, 0.38f, 0.75f}}};
  static constexpr PhaseDomain k_domain{0, 1, true};

  Value<Mode, Vec3> direction{Vec3(0.08f, 1, 0.05f)};

  Strata() : SolidTexture<Strata, Mode>({.size = 0.14f, .turbulence = 0.55f, .turbulence_size = 7, .turbulence_octaves = 6.5f}) {}

  static constexpr auto parameters() {
    return std::tuple_cat(std::tuple{parameter("direction", &Strata::direction, "across the layers").nonzero()},
                          Strata::common_parameters());
  }

  // Sampled:
  PhaseMixture mixture(const Place& place) const { return phase(place); }

  SpreadPhase phase(const Place& place) const {
    const Vec3 along = glm::normalize(direction);
    const SpreadPhase layers = this->turbulent(place, glm::dot(along, place.p), along);
    return {layers.mean / k_layers, layers.variance / (k_layers * k_layers)};
  }

  float profile(float phase) const {
    // Each border is moved by up to 0.45 layers from where equal layers have theirs.
    const float place = phase * k_layers;
    int layer = static_cast<int>(place);
    if (place < border(layer)) --layer;
    if (place >= border(layer + 1)) ++layer;
    const float height = (place - border(layer)) / (border(layer + 1) - border(layer));
    const float tone = unit_of(random(2, layer)), fading = 0.3f * unit_of(random(3, layer));
    return std::clamp(tone + fading * (height - 0.5f), 0.f, 1.f);
  }

private:
  static constexpr int k_layers = 16;

  uint32_t random(uint32_t what, int layer) const {
    return scrambled(this->stream(what) + static_cast<uint32_t>((layer + k_layers) % k_layers));
  }
  float border(int layer) const { return static_cast<float>(layer) + 0.9f * (unit_of(random(4, layer)) - 0.5f); }
};

} // namespace kelpie
