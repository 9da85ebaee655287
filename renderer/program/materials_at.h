// What a field is made of at a point.
#pragma once

#include <vector>

#include "materials/material.h"
#include "renderer/program/evaluate.h"

namespace kelpie {

/// A material with its share of what is at a point, and the point in the space where the material lives.
struct MaterialAt {
  MaterialIndex material;
  float share;
  Vec3 position;
  Footprint footprint;
};

/// The materials that make a field at a point of the world, which is seen by a footprint: each node's value and its material are joined
/// by the operators' `shares` (Barbier, Galin, Akkouche, section 4; methods.md section 2). The shares sum to at most 1: the rest is of
/// leaves that have no material, or there is no field. `code` is all of the program, which has identities and stands
/// (at_with_materials()), or what was pruned for values around the point.
void materials_at(const FieldProgram& program, const CodeView& code, const Vec3d& p, const Footprint& footprint,
                  std::vector<MaterialAt>& out);

} // namespace kelpie
