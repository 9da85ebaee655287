// Liquid that has run together evens out along the body.
#pragma once

#include <span>
#include <vector>

#include "base/vec.h"

namespace kelpie {

/// A part of a liquid at a moment.
struct LiquidPart {
  Vec3d centre{0};
  double radius = 1; ///< of influence
  double mass = 1;   ///< W R^3
  double wanted = 1; ///< the density at which it rests
};

/// How dense the parts lie at the centre of each: about the sum of their potentials.
std::vector<double> densities(std::span<const LiquidPart>);

/// Where the parts go if what lies denser than it should pushes its neighbours away, a little, about as far as parts reach: along limbs and
/// within sheets, where their neighbours are, and hardly out of them. So what ran together closes the gaps that it left.
std::vector<Vec3d> spread(std::span<const LiquidPart>);

} // namespace kelpie
