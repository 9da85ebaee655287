// The commands. Each is one file that adds its subcommand, options and callback to the app; a callback
// throws kelpie::Error for anything a user can mend, and main() turns it into error lines and the exit status.
#pragma once

#include <string>

#include <CLI/CLI.hpp>

#include "base/error.h"

namespace kelpie {

void add_check(CLI::App&);
void add_fit(CLI::App&);
void add_features(CLI::App&);
void add_kinds(CLI::App&);
void add_liquid(CLI::App&);
void add_match(CLI::App&);
void add_mesh(CLI::App&);
void add_movie(CLI::App&);
void add_render(CLI::App&);
void add_schema(CLI::App&);
void add_sheet(CLI::App&);
void add_swatches(CLI::App&);
void add_report(CLI::App&);
void add_view(CLI::App&);

/// Prints `warning: …` lines to stderr.
void print_warnings(const Diagnostics&);

/// For options that name a file to write: refuses names that end as another format's do, or in the number of a frame. What has no ending
/// is fine.
CLI::Validator ends_in(const std::string& ending);

} // namespace kelpie
