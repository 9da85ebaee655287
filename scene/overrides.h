// `--set path=value`: changes to a document before anything is made of it, so that every check holds.
#pragma once

#include "scene/document.h"

namespace kelpie {

/// Applies assignments such as `shapes.drop.threshold=1.1` or `shapes.0.field.children.1.radius=2`, in
/// order. A step is a key, or an element of a list by its index or its "name"; keys that are not there
/// yet are made (the reader knows whether they exist). The value is JSON, or else a bare string.
void apply_overrides(Document&, const std::vector<std::string>& assignments, ProblemList&);

/// The same of one path and its value, which stands at `at`.
void apply_override(Document&, std::string_view path, JsonValue value, TextPosition at, ProblemList&);

} // namespace kelpie
