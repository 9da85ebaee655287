// Named variations of a scene: which values they have instead of the scene's own.
#pragma once

#include "scene/document.h"

namespace kelpie {

/// Applies one of the document's `recipes`: each of its members is a path and a value, as `--set` has them. A name that is not there
/// is a problem.
void apply_recipe(Document&, const std::string& name, ProblemList&);

/// In the order in which they stand.
std::vector<std::string> recipe_names(const Document&);

/// No picture depends on recipes that were not taken.
void remove_recipes(Document&);

} // namespace kelpie
