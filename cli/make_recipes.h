// Recipes that nobody has written: children drawn at random, and those of each two parents.
#pragma once

#include <string>
#include <vector>

namespace kelpie {

/// Draws recipes for all metamorphoses of a scene file: for each feature one parent, or two of them mixed; and one or two for the places,
/// sizes and directions of all features, so that these meet as they do there. What differs only in "left" and "right" is drawn together, so
/// that children are symmetric. Returns a library (JSON) with the recipes random_001, random_002, …, the same on every machine. Throws
/// Error bad_data where there is no metamorphosis.
std::string random_recipes(const std::string& scene, int count, unsigned seed);

/// Recipes of each two objects of the only metamorphosis of a scene file.
struct PairRecipes {
  std::string library;            ///< JSON with the recipes pair_1_1, pair_1_2, … pair_2_1, …
  std::vector<std::string> names; ///< of the objects, or their numbers
};

/// Two parts of the first object and one of the second in all features, so that pair_1_2 is not pair_2_1, and pair_1_1 is the first alone.
/// Throws Error bad_data where there is not one metamorphosis.
PairRecipes pair_recipes(const std::string& scene);

} // namespace kelpie
