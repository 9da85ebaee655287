// How large the blobs and skeletons of a program are: what the sizes of cells and of offsets follow.
#pragma once

#include "field/complex/detail.h"
#include "renderer/program/program.h"

namespace kelpie {

/// Blobs and skeletons of a code.
size_t element_count(const Code&);

/// The smallest radius of influence (half the smallest side of a skeleton's support), in world units.
double smallest_radius(const FieldProgram&, const Code&);

/// Which elements of a program are thin: far longer than their smallest radius. Of cells as small as that it would take ever more, by
/// the square of their ratio for a disc, and far below what a picture shows. So for thin elements a pixel is small enough.
class ThinElements {
public:
  explicit ThinElements(const FieldProgram&);

  bool are_there() const { return are_there_; }
  /// The smallest radius by which a box is divided: smallest_radius(), but that of thin elements is a pixel at least, where
  /// the box is nearest to the eye.
  double dividing_radius(const Code&, const Box3d& box, const PixelScale& pixels) const;

private:
  bool is_thin(const Instruction&) const;

  const FieldProgram& program_;
  std::vector<double> space_aspects_; ///< of the affine map of each space: its largest factor of lengths over its smallest, about
  bool are_there_ = false;
};

/// The smallest radius of influence of the skeletons, without their own size, in world units; infinite if there is none.
double smallest_influence(const FieldProgram&, const Code&);

/// How fine the finest lattice is by whose samples something is known, in world units; infinite if there is none. Bounds of it are
/// narrow over few voxels only.
double smallest_lattice(const FieldProgram&, const Code&);

} // namespace kelpie
