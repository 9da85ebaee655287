// A solid, hollowed out.
#pragma once

#include "field/mesh/triangle_tree.h"
#include "renderer/mesh/solid.h"

namespace kelpie {

/// A straight hole with round ends.
struct DrainHole {
  Vec3d from{0}, to{0};
  double radius = 0;
};

/// What of a solid is no further than `wall` from its surface, but for drain holes. Distances are those to a mesh of the surface, so that
/// the outer side is as good as that, and sides of holes and cavity are exact.
class ShellSolid : public Solid {
public:
  /// All must outlive it.
  ShellSolid(const Solid& solid, const TriangleTree& surface, double wall, std::vector<DrainHole> holes)
      : solid_(solid), surface_(surface), wall_(wall), holes_(std::move(holes)) {}

  Box3d bounds() const override { return solid_.bounds(); }
  Code code() const override { return solid_.code(); }
  InBox in_box(const Box3d&, const Code& parent) const override;
  /// A distance: no slope of it is more than 1.
  double value(const Code&, const Vec3d&) const override;
  Vec3d gradient(const Code&, const Vec3d&) const override;
  bool is_one_sheet(const Code&, const Box3d&) const override;
  double close() const override { return 1e-6 * wall_; }

private:
  const Solid& solid_;
  const TriangleTree& surface_;
  double wall_;
  std::vector<DrainHole> holes_;
};

} // namespace kelpie
