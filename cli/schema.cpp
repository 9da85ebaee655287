#include "base/standard_streams.h"
#include "cli/command.h"
#include "scene/manual.h"

namespace kelpie {

void add_schema(CLI::App& app) {
  CLI::App& command = *app.add_subcommand("schema", "the JSON schema of scene files, for editors");
  command.footer("An editor that knows the schema completes and checks scenes while you type:\n"
                 "  kelpie schema > kelpie.schema.json\n"
                 "and in the scene, beside \"kelpie\": 1,\n"
                 "  \"$schema\": \"kelpie.schema.json\"\n");
  command.callback([] { print_result(json_schema()); });
}

} // namespace kelpie
