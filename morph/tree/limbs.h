// Generalized cylinders of different numbers of points, as ones that can be mixed.
#pragma once

#include "morph/field_node.h"

namespace kelpie {

/// Makes both curves of as many points: where they are not, of as many cubic Bézier pieces, along which they run as before; of the shorter
/// one pieces are divided. The two are expanded as finely as the finer of them, in pixels if one of them is. False where the curves cannot
/// be changed so: a lone point, a Bézier curve of more than four points, a thousand points.
void give_equal_pieces(GeneralizedCylinder<AnimatedMode>&, GeneralizedCylinder<AnimatedMode>&);

} // namespace kelpie
