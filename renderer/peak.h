// How large a field gets: whether it has a surface at all.
#pragma once

#include <optional>

#include "renderer/program/program.h"

namespace kelpie {

/// A field counts as no greater than its threshold up to this part of it: blobs are bounded in float.
inline constexpr double k_peak_margin = 1e-5;

enum class Surface {
  none,    ///< proved: the field is nowhere greater than its threshold
  present, ///< proved: somewhere it is
  unknown, ///< too much work to tell
};

/// Whether a program that stands has a surface: boxes are bounded and halved, the one with the largest bound first, until a
/// place is found where the field exceeds the threshold, or no box is left where it may. `work` is taken from as it goes: about
/// 5 ns each.
Surface find_surface(const FieldProgram&, int64_t& work);

/// An upper bound of a field everywhere, in the same way: within 1e-4 of its largest value, if the work suffices.
double peak_of(const FieldProgram&, int64_t& work);

/// What a leaf of the program may have by itself at most: the least of all leaves of which that is above 0; infinite if there is none.
double peak_of_weakest_leaf(const FieldProgram&);

/// A skeleton whose own potential is only the threshold, and which nothing adds to on much of it: there the field reaches the
/// threshold, and no point is inside. The number of its node, or that of the complex primitive that it is a piece of. Looks at a
/// few skeletons, of those that no warp bends, in a few places.
std::optional<size_t> skeleton_at_threshold(const FieldProgram&);

} // namespace kelpie
