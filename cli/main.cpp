#include <algorithm>
#include <cctype>
#include <csignal>
#include <filesystem>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/leftovers.h"
#include "base/standard_streams.h"
#include "base/suggest.h"
#include "cli/command.h"
#include "cli/failure.h"

namespace kelpie {

void print_warnings(const Diagnostics& diagnostics) {
  for (const Problem& p : diagnostics.warnings()) print_message(fmt::format("warning: {}\n", to_string(p)));
}

CLI::Validator ends_in(const std::string& ending) {
  const auto problem = [=](std::string& name) -> std::string {
    std::string found = std::filesystem::path(name).extension().string();
    std::transform(found.begin(), found.end(), found.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    const bool is_format = std::any_of(found.begin(), found.end(), [](unsigned char c) { return std::isalpha(c) != 0 || c == '#'; });
    return is_format && found != ending ? fmt::format("{} is written here: \"{}\" must end in {}", ending.substr(1), name, ending) : "";
  };
  return {problem, ""};
}

namespace {

/// CLI11 says no more of a mistyped command than that one is required.
void check_command_is_known(const CLI::App& app, int argc, char** argv) {
  std::vector<std::string_view> known;
  for (const CLI::App* command : app.get_subcommands({})) known.push_back(command->get_name());
  if (argc < 2)
    throw Error(ExitStatus::usage, fmt::format("which command? One of {}; kelpie --help explains them", fmt::join(known, ", ")));
  const std::string_view name = argv[1];
  if (!name.empty() && name.front() == '-') return; // --help, --version: CLI11's
  if (std::find(known.begin(), known.end(), name) == known.end())
    throw Error(ExitStatus::usage, fmt::format("unknown command \"{}\"{}", name, suggestion(name, known)));
}

int run(int argc, char** argv) {
  CLI::App app{"kelpie renders implicit surfaces: shapes that flow, blend and turn into one another."};
  app.set_version_flag("--version", "kelpie " KELPIE_VERSION);
  app.require_subcommand(1);
  app.failure_message(CLI::FailureMessage::simple);
  app.get_formatter()->column_width(34);
  for (const auto add : {KELPIE_COMMANDS}) add(app);
  check_command_is_known(app, argc, argv);
  try {
    app.parse(argc, argv);
  } catch (const CLI::CallForHelp&) {
    print_result(app.help());
  } catch (const CLI::CallForVersion& e) {
    print_result(std::string(e.what()) + "\n");
  } catch (const CLI::ParseError& e) {
    throw Error(ExitStatus::usage, e.what());
  }
  return static_cast<int>(ExitStatus::ok);
}

} // namespace
} // namespace kelpie

int main(int argc, char** argv) {
  std::signal(SIGPIPE, SIG_IGN); // a reader that goes away is a failed write (74), not a death
  std::signal(SIGXFSZ, SIG_IGN);
  try {
    kelpie::reserve_standard_streams();
    kelpie::clean_up_on_signals();
    return kelpie::run(argc, argv);
  } catch (...) {
    return kelpie::report_failure();
  }
}
