#include <memory>

#include "base/standard_streams.h"
#include "cli/command.h"
#include "morph/tree/skeleton_graph.h"
#include "scene/manual.h"

namespace kelpie {

void add_kinds(CLI::App& app) {
  CLI::App& command = *app.add_subcommand("kinds", "the manual of all that scene files may say");
  command.footer("Without NAME: every kind in one line. With NAME: its page, with all parameters, ranges and defaults.\n"
                 "  kelpie kinds point      a kind of field\n"
                 "  kelpie kinds camera     a part of the scene\n"
                 "  kelpie kinds keys       how values change over time\n"
                 "  kelpie kinds expression    formulas\n");
  auto name = std::make_shared<std::string>();
  command.add_option("NAME", *name, "a kind, a part of the scene, or a form of value");
  auto wants_graph = std::make_shared<bool>(false);
  command.add_flag("--graph", *wants_graph, "how skeletons become one another in an animorphosis, for Graphviz's `dot`")->excludes("NAME");
  command.callback([=] { print_result(*wants_graph ? skeleton_graph_dot() : name->empty() ? manual_index() : manual_page(*name)); });
}

} // namespace kelpie
