#pragma once

#include <array>

#include "base/kind.h"
#include "base/vec.h"
#include "colour/colour.h"

namespace kelpie {

/// How samples are spread around a pixel: by importance, so every sample weighs the same.
enum class PixelFilter { centre, box, gaussian };

template <>
struct EnumNames<PixelFilter> {
  static constexpr std::array<std::pair<std::string_view, PixelFilter>, 3> values{
      {{"centre", PixelFilter::centre}, {"box", PixelFilter::box}, {"gaussian", PixelFilter::gaussian}}};
};

enum class Aov { Z, P, N, albedo, cost, motion };

template <>
struct EnumNames<Aov> {
  static constexpr std::array<std::pair<std::string_view, Aov>, 6> values{
      {{"Z", Aov::Z}, {"P", Aov::P}, {"N", Aov::N}, {"albedo", Aov::albedo}, {"cost", Aov::cost}, {"motion", Aov::motion}}};
};

/// What a camera ray that misses everything shows. In scene files: "environment", "transparent" or a colour.
struct Background {
  enum class Kind { environment, transparent, colour } kind = Kind::environment;
  Colour colour{};
};

/// The film is the same in every frame.
template <class Mode>
struct Film {
  static constexpr std::string_view k_name = "film";
  static constexpr std::string_view k_doc = "Size and quality of the picture, and what it holds besides colour.";

  Vec2i resolution{1280, 720};
  int spp = 64;
  int bounces = 8;
  std::vector<Aov> aovs{Aov::Z, Aov::P, Aov::N, Aov::albedo};
  PixelFilter filter = PixelFilter::gaussian;
  Background background{};
  bool specular_antialiasing = true;
  bool tinted_shadows = false;

  static constexpr auto parameters() {
    return std::tuple{
        parameter("resolution", &Film::resolution, "width and height").in(Unit::pixels).at_least(1).at_most(65536),
        parameter("spp", &Film::spp, "samples per pixel").at_least(1).at_most(1 << 20),
        parameter("bounces", &Film::bounces, "how often light is followed from surface to surface; 0: direct light only")
            .at_least(0)
            .at_most(1000),
        parameter(
            "aovs", &Film::aovs,
            "further channels: Z (distance along the camera axis), P (world position), N (world normal), albedo, cost (evaluations of "
            "fields for each sample of the pixel; takes time), motion (of the surface in the picture to the next frame, in pixels)"),
        parameter("filter", &Film::filter, "`gaussian` (smooth), `box` (one pixel wide), `centre` (no antialiasing)"),
        parameter("background", &Film::background, "`environment`, `transparent`, or a colour"),
        parameter("specular_antialiasing", &Film::specular_antialiasing,
                  "blurs highlights by as much as the surface bends within a pixel, so that small shiny things do not sparkle"),
        parameter("tinted_shadows", &Film::tinted_shadows,
                  "light goes straight through clear shapes, and takes their colour: soft, clean shadows of glass, without caustics"),
    };
  }
};

} // namespace kelpie
