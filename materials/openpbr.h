// The parameters of a surface: those of OpenPBR 1.1 (Academy Software Foundation), by their names.
#pragma once

#include "base/kind.h"
#include "base/table.h"
#include "colour/colour.h"

namespace kelpie {

/// Of `bump_height`, which every kind of surface has.
inline constexpr std::string_view k_bump_height_doc =
    "how far the surface seems to stand out: where a pattern or a blend of materials makes it vary, light sees slopes. The outline stays";

template <class Mode>
struct OpenPbr {
  static constexpr std::string_view k_name = "openpbr";
  static constexpr std::string_view k_doc =
      R"(Any surface, by the parameters of OpenPBR 1.1: matte, metal, plastic, glass, lacquer, and all between.

From below: a *base*, which is a metal (`base_metalness`), or a dielectric over a diffuse ground, below which light may wander
(`subsurface_weight`), or what light passes through (`transmission_weight`); above it a *coat*. `matte`, `metal` and `glass` are short forms of this. Lengths are in scene units.)";

  Value<Mode, float> base_weight{1.f};
  Value<Mode, Colour> base_color{Colour{Vec3(0.8f)}};
  Value<Mode, float> base_diffuse_roughness{0.f};
  Value<Mode, float> base_metalness{0.f};
  Value<Mode, float> specular_weight{1.f};
  Value<Mode, Colour> specular_color{Colour{Vec3(1)}};
  Value<Mode, float> specular_roughness{0.3f};
  Value<Mode, float> specular_roughness_anisotropy{0.f};
  Value<Mode, float> specular_ior{1.5f};
  Value<Mode, float> transmission_weight{0.f};
  Value<Mode, Colour> transmission_color{Colour{Vec3(1)}};
  Value<Mode, float> transmission_depth{0.f};
  Value<Mode, float> transmission_dispersion_scale{0.f};
  Value<Mode, float> transmission_dispersion_abbe_number{20.f};
  Value<Mode, float> subsurface_weight{0.f};
  Value<Mode, Colour> subsurface_color{Colour{Vec3(0.8f)}};
  Value<Mode, float> subsurface_radius{1.f};
  Value<Mode, Colour> subsurface_radius_scale{Colour{Vec3(1, 0.5f, 0.25f)}};
  Value<Mode, float> subsurface_scatter_anisotropy{0.f};
  Value<Mode, float> coat_weight{0.f};
  Value<Mode, Colour> coat_color{Colour{Vec3(1)}};
  Value<Mode, float> coat_roughness{0.f};
  Value<Mode, float> coat_ior{1.6f};
  Value<Mode, float> coat_darkening{1.f};
  Value<Mode, float> thin_film_weight{0.f};
  Value<Mode, float> thin_film_thickness{0.5f};
  Value<Mode, float> thin_film_ior{1.4f};
  Value<Mode, float> emission_luminance{0.f};
  Value<Mode, Colour> emission_color{Colour{Vec3(1)}};
  Value<Mode, Vec3> geometry_tangent{Vec3(1, 0, 0)};
  Value<Mode, float> bump_height{0.f};

  static constexpr auto parameters() {
    return std::tuple{
        parameter("base_weight", &OpenPbr::base_weight, "a factor of `base_color`").at_least(0).at_most(1),
        parameter("base_color", &OpenPbr::base_color, "of the diffuse ground its albedo; of a metal its reflectance straight on")
            .at_least(0)
            .at_most(1),
        parameter("base_diffuse_roughness", &OpenPbr::base_diffuse_roughness, "of the ground: 0 is Lambert's, 1 is dusty and flat")
            .at_least(0)
            .at_most(1),
        parameter("base_metalness", &OpenPbr::base_metalness, "0: a dielectric, 1: a metal").at_least(0).at_most(1),
        parameter("specular_weight", &OpenPbr::specular_weight,
                  "of a dielectric: how strong it reflects beside what `specular_ior` says; of a metal a factor of all it reflects")
            .at_least(0),
        parameter("specular_color", &OpenPbr::specular_color,
                  "of a dielectric the colour of its reflection; of a metal that of its reflectance at 82 degrees, beside Schlick's")
            .at_least(0)
            .at_most(1),
        parameter("specular_roughness", &OpenPbr::specular_roughness, "0 is a mirror, 1 is dull; the microfacets' alpha is its square")
            .at_least(0)
            .at_most(1),
        parameter("specular_roughness_anisotropy", &OpenPbr::specular_roughness_anisotropy,
                  "0: the same in all directions; towards 1: brushed along `geometry_tangent`")
            .at_least(0)
            .at_most(1),
        parameter("specular_ior", &OpenPbr::specular_ior, "index of refraction of the dielectric").at_least(1).at_most(4),
        parameter("transmission_weight", &OpenPbr::transmission_weight, "how much of the dielectric is clear instead of over a ground")
            .at_least(0)
            .at_most(1),
        parameter("transmission_color", &OpenPbr::transmission_color,
                  "what is left of white light after `transmission_depth`; where that is 0, a factor each time light passes the surface")
            .at_least(0)
            .at_most(1),
        parameter("transmission_depth", &OpenPbr::transmission_depth, "the way through the dielectric that colours light; 0: see there")
            .in(Unit::length)
            .at_least(0),
        parameter("transmission_dispersion_scale", &OpenPbr::transmission_dispersion_scale,
                  "how far the dielectric spreads colours, as a part of what its Abbe number says; 0: not at all")
            .at_least(0)
            .at_most(1),
        parameter("transmission_dispersion_abbe_number", &OpenPbr::transmission_dispersion_abbe_number,
                  "the lower, the wider colours are spread: 20 much, 55 diamond, 64 crown glass")
            .at_least(9)
            .at_most(91),
        parameter("subsurface_weight", &OpenPbr::subsurface_weight,
                  "how much of the ground lets light in, which wanders below the surface and comes out elsewhere: wax, jade, skin")
            .at_least(0)
            .at_most(1),
        parameter("subsurface_color", &OpenPbr::subsurface_color, "of a thick body, how much of such light comes out")
            .at_least(0)
            .at_most(1),
        parameter(
            "subsurface_radius", &OpenPbr::subsurface_radius,
            "how far light goes below the surface between two collisions, on the average: a hundredth of a body is opaque, a tenth waxy")
            .in(Unit::length)
            .above(0),
        parameter("subsurface_radius_scale", &OpenPbr::subsurface_radius_scale, "factors of that, by colour").at_least(0).at_most(1),
        parameter("subsurface_scatter_anisotropy", &OpenPbr::subsurface_scatter_anisotropy,
                  "where a collision turns light: 0: anywhere; towards 1: it goes nearly straight on; below 0: back")
            .at_least(-0.99)
            .at_most(0.99),
        parameter("coat_weight", &OpenPbr::coat_weight, "how much of the surface has a clear coat above it").at_least(0).at_most(1),
        parameter("coat_color", &OpenPbr::coat_color, "what the coat leaves of light that goes in and out").at_least(0).at_most(1),
        parameter("coat_roughness", &OpenPbr::coat_roughness, "as `specular_roughness`").at_least(0).at_most(1),
        parameter("coat_ior", &OpenPbr::coat_ior, "index of refraction of the coat").at_least(1).at_most(4),
        parameter("coat_darkening", &OpenPbr::coat_darkening, "how much light that the coat throws back down darkens the base")
            .at_least(0)
            .at_most(1),
        parameter("thin_film_weight", &OpenPbr::thin_film_weight, "how much of the base has a thin film on it").at_least(0).at_most(1),
        parameter("thin_film_thickness", &OpenPbr::thin_film_thickness, "of the film, in micrometres").at_least(0),
        parameter("thin_film_ior", &OpenPbr::thin_film_ior, "index of refraction of the film").at_least(1).at_most(4),
        parameter("emission_luminance", &OpenPbr::emission_luminance, "radiance that the surface emits, a factor of `emission_color`")
            .at_least(0),
        parameter("emission_color", &OpenPbr::emission_color, "colour of what it emits").at_least(0),
        parameter("geometry_tangent", &OpenPbr::geometry_tangent, "the direction of brushing: its part along the surface counts").nonzero(),
        parameter("bump_height", &OpenPbr::bump_height, k_bump_height_doc).in(Unit::length),
    };
  }

  // Sampled:
  const OpenPbr& surface() const { return *this; }
};

/// A surface at one point: what every kind of surface comes to.
using SurfaceParameters = OpenPbr<SampledMode>;

// Mixes: sums of weight * what a kind of surface says, for weights that sum to 1. What adds materials to one takes any of them:
//   void add(const Kind&, float weight);                          a surface of any kind
//   void add_part(const Mix&, float height_scale, float weight);  another mix, whose heights are in another unit
//   float weight() const;                                         the weights so far
//   sum() const;

/// Of whole surfaces.
class SurfaceMix {
public:
  template <class Kind>
  void add(const Kind& kind, float weight) {
    const SurfaceParameters& surface = kind.surface();
    if (weight <= 0) return;
    if (weight >= 1) {
      sum_ = surface, weight_ = 1;
      return;
    }
    const bool is_first = weight_ == 0;
    for_each_value(
        [&]<class T>(const ParameterRules&, T& sum, const T& value) {
          if constexpr (std::is_same_v<T, Colour> || std::is_same_v<T, float> || std::is_same_v<T, Vec3>)
            sum = is_first ? value * weight : sum + value * weight;
        },
        sum_, surface);
    weight_ += weight;
  }
  void add_part(const SurfaceMix& part, float height_scale, float weight) {
    SurfaceParameters surface = part.sum();
    surface.bump_height *= height_scale;
    add(surface, weight);
  }
  float weight() const { return weight_; }
  const SurfaceParameters& sum() const { return sum_; }

private:
  SurfaceParameters sum_;
  float weight_ = 0;
};

/// Of their heights alone.
class HeightMix {
public:
  template <class Kind>
  void add(const Kind& kind, float weight) {
    add_height(kind.bump_height, weight);
  }
  void add_part(const HeightMix& part, float height_scale, float weight) { add_height(part.sum() * height_scale, weight); }
  float weight() const { return weight_; }
  float sum() const { return sum_; }

private:
  void add_height(float height, float weight) {
    if (weight <= 0) return;
    if (weight >= 1)
      sum_ = height, weight_ = 1;
    else
      sum_ += height * weight, weight_ += weight;
  }

  float sum_ = 0, weight_ = 0;
};

} // namespace kelpie
