#pragma once

#include <filesystem>

namespace kelpie {

/// Where what was costly to make is kept for the next run: $XDG_CACHE_HOME/kelpie, or ~/.cache/kelpie. Empty where there is no home
/// to keep anything in.
std::filesystem::path cache_folder();

} // namespace kelpie
