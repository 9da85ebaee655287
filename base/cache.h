// What was costly to make is kept for the next run, in $XDG_CACHE_HOME/kelpie or ~/.cache/kelpie. A cache never fails: what is not there,
// cannot be read or is not what was written is made anew.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "base/error.h"

namespace kelpie {

/// What was kept under this name (a file name), unaltered, or nothing.
std::optional<std::string> read_cached(const std::string& name);

/// Keeps the bytes, with a checksum; warns where that cannot be done: "WHAT not cached: reason".
void write_cached(const std::string& name, std::string_view bytes, const std::string& what, Diagnostics& diagnostics);

} // namespace kelpie
