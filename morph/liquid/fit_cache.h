// Fits of mesh files, kept between runs.
#pragma once

#include <string>

#include "morph/liquid/fit.h"

namespace kelpie {

/// Loads the mesh and fits blobs to it, or takes them from the cache: $XDG_CACHE_HOME/kelpie or ~/.cache/kelpie, keyed
/// by the content of the file, the options and the version. A cache that cannot be read or written
/// is only a warning. Throws as load_mesh and fit_blobs do.
FitResult fit_mesh_file(const std::string& path, const FitOptions&, bool use_cache, Diagnostics&);

} // namespace kelpie
