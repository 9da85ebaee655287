// How the parts of shapes correspond, as data, as a picture, and in a few lines: what `kelpie match` writes.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "morph/liquid/interpolate.h"
#include "scene/grow_trees.h"

namespace kelpie {

/// A passage of a liquid in the scene, as the parts into which its two clouds are cut.
struct MatchedLiquid {
  SourcePosition where;
  std::vector<std::string> shapes;  ///< those that it is in
  BlobCloud from, to;               ///< at the beginning and at the end, of as many parts in the same order
  size_t passage = 1, passages = 1; ///< which, of so many
};

struct MatchReport {
  std::string scene;
  std::optional<int> frame; ///< at which places are shown; none: that at which parts were compared
  std::vector<GrownTree> trees;
  std::vector<MatchedLiquid> liquids;

  double frame_of(const GrownTree& tree) const { return frame ? *frame : tree.match.frame; }
};

/// "liquid of drop, passage 1 of 2"
std::string title_of(const MatchedLiquid&);

/// The potential's mass |W| R^3 of each part at the beginning, in shares of all.
std::vector<double> amounts_of(const MatchedLiquid&);

/// All that was decided: for programs.
std::string match_json(const MatchReport&);
/// SVG: both ends side by side, with a line from each part to what it becomes.
std::string match_picture(const MatchReport&);
/// How many parts found their counterpart how, a line for each animorphosis and each liquid.
std::string match_summary(const MatchReport&);

} // namespace kelpie
