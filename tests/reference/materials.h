// What a field is made of (methods.md, section 2: TextureTree).
#pragma once

#include "tests/reference/field.h"

namespace reference {

/// A material's share of what is at a point, and the point in the space of the node that has the material.
struct MaterialPart {
  int material;
  double share;
  Vec position;
};

/// One part for each node that has a material and counts at p; those without are left out. Blends in one another are one sum.
std::vector<MaterialPart> materials(const Node&, Vec p, double threshold);

} // namespace reference
