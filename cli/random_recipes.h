// Recipes drawn at random: children that nobody has thought of.
#pragma once

#include <string>

namespace kelpie {

/// Draws recipes for all metamorphoses of a scene file: for each feature one parent, or two of them mixed; and one or two for the places,
/// sizes and directions of all features, so that these meet as they do there. What differs only in "left" and "right" is drawn together, so
/// that children are symmetric. Returns a library (JSON) with the recipes random_001, random_002, …, the same on every machine. Throws
/// Error bad_data where there is no metamorphosis.
std::string random_recipes(const std::string& scene, int count, unsigned seed);

} // namespace kelpie
