// How solids are described to the solvers of trees: plane polygons, rectangles, and what is done with them.
#pragma once

#include "field/kinds.h"
#include "renderer/cells/tree.h"

namespace kelpie {

/// Whence a cell sees solids.
struct SolidPlace {
  Vec3d centre; ///< of the cell, in the solid's space
  Mat3d linear; ///< from the leaf's base (TreeView::spaces, or the world) to that space
  double reach; ///< how far any point of the cell is from the centre there, at most; infinite if that is not known
};

/// What a signed distance is the distance to.
SectionSolid section_of(const SdfSphere<SampledMode>&);
SectionSolid section_of(const SdfBox<SampledMode>&);
SectionSolid section_of(const SdfCylinder<SampledMode>&);
SectionSolid section_of(const SdfCapsule<SampledMode>&);
SectionSolid section_of(const SdfTorus<SampledMode>&);

/// Appends the parts and edges of a solid to a tree, and says in `leaf` what they are (form, convexity, parts, growth and ends).
void add_parts(const SectionSolid&, const SolidPlace&, Tree&, SolidLeaf& leaf);
void add_parts(const ArcSolid&, const SolidPlace&, Tree&, SolidLeaf& leaf);
/// What lies below the plane through the frame's origin across its axis.
void add_half_space(const AxisFrame&, const SolidPlace&, Tree&, SolidLeaf& leaf);
/// Only the faces that some point of the cell is nearest to.
void add_parts(std::span<const HullFace>, const SolidPlace&, Tree&, SolidLeaf& leaf);

} // namespace kelpie
