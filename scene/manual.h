// What scene files may say, from the same tables that read them.
#pragma once

#include <string>
#include <string_view>

namespace kelpie {

/// Every page of the manual in one line, grouped: parts of a scene, kinds of field, surfaces, lights…
std::string manual_index();

/// The page of a kind (`point`), a part of the scene (`camera`) or a form of value (`colour`). Throws
/// Error usage with a suggestion for a name that has none.
std::string manual_page(std::string_view name);

/// The JSON schema (draft 2020-12) of scene files. A scene that it refuses is refused by the reader as
/// well; the reader checks more (order of keys, files, rules between parameters).
std::string json_schema();

} // namespace kelpie
