// What `kelpie fit` and `kelpie liquid` share.
#pragma once

#include <string>

#include <CLI/CLI.hpp>

#include "cli/mesh_source.h"
#include "cli/progress.h"
#include "morph/liquid/fit.h"

namespace kelpie {

struct FitCommandOptions {
  size_t blobs = 0;   ///< 0: 500, or fewer where they are as good, or what the goals need
  std::string error;  ///< a length, or a percentage of the diagonal; empty: no goal
  double normals = 0; ///< degrees; 0: no goal
  FitShape shape = FitShape::round;
  double weld = 0; ///< 0: chosen by the mesh
  bool no_cache = false;
  ProgressMode progress = ProgressMode::automatic;
};

/// Adds --blobs, --error, --normals, --shape and --weld.
void add_fit_options(CLI::App& command, FitCommandOptions& options);

/// Fits the mesh (or takes the fit from the cache); prints warnings and one line of figures to stderr.
FitResult fit_and_report(const MeshSource& mesh, const FitCommandOptions& options);

} // namespace kelpie
