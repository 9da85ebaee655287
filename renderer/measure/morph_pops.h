// Where a morph jumps: its volume, its area, a part of it, or the picture.
#pragma once

#include <string_view>

#include "renderer/measure/measure_morph.h"

namespace kelpie {

struct Pop {
  enum class Kind { volume, area, part, picture };
  Kind kind = Kind::volume;
  int frame = 0;              ///< the later of the two
  double change = 0;          ///< a share of the whole: of the larger volume or area, or the mean change of a pixel of which 1 is white
  double usual = 0;           ///< the median of the changes around
  std::optional<Vec3d> place; ///< of a part
};

/// `picture_changes`: from each frame to the next, shares of white; none where there are no pictures.
std::vector<Pop> find_pops(const std::vector<FieldMeasures>& frames, const std::vector<double>& picture_changes);

} // namespace kelpie
