// "did you mean": the nearest known name to one that was mistyped.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace kelpie {

/// The known name nearest to `typed` by edit distance (a swap of neighbours counts as one); when none is near
/// enough to be what was meant (a third of the length, at least one edit), the shortest that has it as a word ("sdf_mesh" for
/// "mesh"), or an empty view.
std::string_view nearest_name(std::string_view typed, std::span<const std::string_view> known);

/// ` (did you mean "radius"?)`, or, when nothing is near, `; known: point, segment, …`.
std::string suggestion(std::string_view typed, std::span<const std::string_view> known);

} // namespace kelpie
