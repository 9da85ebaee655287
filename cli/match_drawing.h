// Two ends of a morph side by side, as SVG.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/box.h"

namespace kelpie {

/// A part of either end.
struct DrawnPart {
  enum class Look { paired, loose, exchanged };

  std::vector<Box3d> pieces;
  std::string title{}; ///< all that is said of it, shown where the mouse rests on it
  double hue = 0;      ///< degrees; of paired ones
  Look look = Look::paired;
  bool is_round = false;        ///< its pieces are balls
  std::optional<Vec3d> place{}; ///< of a loose one: where it goes to or comes from

  Vec3d centre() const;
};

/// A part of the one end becomes a part of the other, both by their places in their lists.
struct DrawnLink {
  size_t from, to;
  double width = 1; ///< pixels
};

/// A text where it belongs, if there is room; the first ones have it first.
struct DrawnLabel {
  Vec3d at;
  std::string text;
};

struct DrawnEnd {
  std::vector<DrawnPart> parts;
  std::vector<DrawnLabel> labels;
};

struct MatchDrawing {
  std::string title;
  DrawnEnd from, to;
  std::vector<DrawnLink> links;
};

/// Below one another; each in a side view, or from above where it is flat, both ends at one scale.
std::string svg_of(const std::vector<MatchDrawing>&);

} // namespace kelpie
