// A colour in the scene's working space.
#pragma once

#include "base/vec.h"

namespace kelpie {

/// Scene-linear (the role scene_linear: ACEScg) red, green, blue. A type of its own, so that a colour
/// and a position are never confused; `rgb` is the vector for arithmetic.
struct Colour {
  Vec3 rgb{0};

  friend Colour operator*(Colour c, float s) { return {c.rgb * s}; }
  friend Colour operator+(Colour a, Colour b) { return {a.rgb + b.rgb}; }
  friend bool operator==(const Colour&, const Colour&) = default;
};

/// Relative luminance of a scene-linear (ACEScg, AP1 primaries) colour.
inline float luminance(const Vec3& rgb) { return glm::dot(rgb, Vec3(0.2722287f, 0.6740818f, 0.0536895f)); }

} // namespace kelpie
