// What is between two materials.
#pragma once

#include "materials/material.h"
#include "morph/tree/animorphosis.h"

namespace kelpie {

/// a at s = 0, b at s = 1. Two of one kind with as many stops are one whose numbers go from those of the one to those of the other, so
/// veins stay veins. Any other two are a transition (materials/transition.h), which is completed as they are at `frame`.
MaterialPtr mixed_material(const MaterialPtr& a, const MaterialPtr& b, const Animated<float>& s, MaterialChange how, double frame);

} // namespace kelpie
