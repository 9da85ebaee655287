// What a table cannot say: rules between parameters.
#pragma once

#include "scene/document.h"
#include "scene/scene.h"

namespace kelpie {

/// Two shapes of one name. Works on the document, so that it finds them whatever else is wrong.
void check_names(const Document&, ProblemList&);

/// Rules between the values of a scene that was read without a problem.
void check_scene(const Scene&, const Document&, ProblemList&);

} // namespace kelpie
