// What the tables cannot say of axial deformations.
#pragma once

#include "scene/record_reader.h"

namespace kelpie {

/// Axes whose lists of control points differ in length are problems.
void check_axes(const std::vector<ReadNode>&, const Document&, ProblemList&);

/// Warns of axes whose tubes are cut, at any of their keys, because space would fold in them. Of a good scene only.
void warn_of_folds(const std::vector<ReadNode>&, const Document&, Diagnostics&);

} // namespace kelpie
