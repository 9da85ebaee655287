// What is between two materials.
#pragma once

#include "materials/material.h"
#include "morph/tree/animorphosis.h"

namespace kelpie {

/// a at s = 0, b at s = 1. Two of one kind with as many stops are one whose numbers go from those of the one to those of the other, so
/// veins stay veins. Of any other two, if one is a pattern and they are to grow, b has the share s of space, and goes on along the
/// features of the pattern, as that is at `frame` (methods.md section 5, growth); else they dissolve.
MaterialPtr mixed_material(const MaterialPtr& a, const MaterialPtr& b, const Animated<float>& s, MaterialChange how, double frame);

} // namespace kelpie
