// How a command reads a scene: what render, check, report and sheet share.
#pragma once

#include <CLI/CLI.hpp>

#include "scene/reader.h"

namespace kelpie {

/// Adds --set, --recipes, --allow-path and --no-cache.
void add_read_options(CLI::App& command, ReadOptions& options);

/// Adds --recipe, of which a command takes one.
void add_recipe_option(CLI::App& command, ReadOptions& options);

} // namespace kelpie
