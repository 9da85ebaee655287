#include <algorithm>
#include <cctype>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <new>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/atomic_file.h"
#include "base/suggest.h"
#include "cli/command.h"

namespace kelpie {

void print_warnings(const Diagnostics& diagnostics) {
  for (const Problem& p : diagnostics.warnings()) fmt::print(stderr, "warning: {}\n", to_string(p));
}

CLI::Validator ends_in(const std::string& ending) {
  const auto problem = [=](std::string& name) -> std::string {
    std::string found = std::filesystem::path(name).extension().string();
    std::transform(found.begin(), found.end(), found.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    const bool is_format = std::any_of(found.begin(), found.end(), [](unsigned char c) { return std::isalpha(c) != 0; });
    return is_format && found != ending ? fmt::format("{} is written here: \"{}\" must end in {}", ending.substr(1), name, ending) : "";
  };
  return {problem, ""};
}

void print_result(std::string_view text) {
  const bool is_written = std::fwrite(text.data(), 1, text.size(), stdout) == text.size() && std::fflush(stdout) == 0;
  if (!is_written) throw Error(ExitStatus::cannot_write, fmt::format("cannot write to stdout: {}", std::strerror(errno)));
}

namespace {

int status(ExitStatus s) { return static_cast<int>(s); }

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
  try {
    check_command_is_known(app, argc, argv);
    app.parse(argc, argv);
    return status(ExitStatus::ok);
  } catch (const CLI::CallForHelp& e) {
    return app.exit(e);
  } catch (const CLI::CallForAllHelp& e) {
    return app.exit(e);
  } catch (const CLI::CallForVersion& e) {
    return app.exit(e);
  } catch (const CLI::ParseError& e) {
    fmt::print(stderr, "error: {}\n", e.what());
    return status(ExitStatus::usage);
  } catch (const Interrupted& e) {
    unlink_part_files();
    std::signal(e.signal, SIG_DFL);
    std::raise(e.signal);
    return status(ExitStatus::internal); // not reached
  } catch (const Error& e) {
    for (const Problem& p : e.problems) fmt::print(stderr, "error: {}\n", to_string(p));
    return status(e.status);
  } catch (const std::bad_alloc&) {
    fmt::print(stderr, "error: out of memory\n");
    return status(ExitStatus::out_of_memory);
  } catch (const std::exception& e) {
    fmt::print(stderr, "error: internal: {}\n", e.what());
    return status(ExitStatus::internal);
  }
}

} // namespace
} // namespace kelpie

int main(int argc, char** argv) {
  std::signal(SIGPIPE, SIG_IGN); // a reader that goes away is a failed write (74), not a death
  std::signal(SIGXFSZ, SIG_IGN);
  return kelpie::run(argc, argv);
}
