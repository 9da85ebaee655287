#include "cli/failure.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <exception>
#include <filesystem>
#include <new>

#include <unistd.h>

#include <fmt/format.h>

#include "base/error.h"
#include "base/leftovers.h"
#include "base/standard_streams.h"

namespace kelpie {

namespace {

// Fixed storage: it is read when there is no memory, maybe by another thread.
std::array<char, 200> g_activity{"starting"};
std::atomic<bool> g_memory_ran_out{false};

int status(ExitStatus s) { return static_cast<int>(s); }

int report_out_of_memory() noexcept {
  std::array<char, 300> line;
  const auto end = fmt::format_to_n(line.data(), line.size(), "error: out of memory while {}\n", g_activity.data()).out;
  print_message({line.data(), static_cast<size_t>(end - line.data())});
  return status(ExitStatus::out_of_memory);
}

int report(ExitStatus s, const std::string& message) {
  print_message(fmt::format("error: {}\n", message));
  return status(s);
}

/// Threads that cannot be started lack memory for their stacks. The standard library and TBB have in common what they say of it.
bool is_lack_of_memory(const std::exception& e) {
  const std::string_view what = e.what();
  return what.find(std::strerror(EAGAIN)) != what.npos || what.find(std::strerror(ENOMEM)) != what.npos;
}

/// Rethrows what was caught.
int report_caught() {
  try {
    throw;
  } catch (const Error& e) {
    const bool is_of_the_work = e.status == ExitStatus::internal || e.status == ExitStatus::bad_data;
    if (g_memory_ran_out && is_of_the_work) return report_out_of_memory();
    for (const Problem& p : e.problems) report(e.status, to_string(p));
    return status(e.status);
  } catch (const std::bad_alloc&) {
    return report_out_of_memory();
  } catch (const std::filesystem::filesystem_error& e) {
    return report(ExitStatus::missing_input, fmt::format("{}: {}", e.path1().string(), e.code().message()));
  } catch (const std::exception& e) {
    if (g_memory_ran_out || is_lack_of_memory(e)) return report_out_of_memory();
    return report(ExitStatus::internal, fmt::format("internal: {}", e.what()));
  }
}

[[noreturn]] void end_in_failure() {
  static std::atomic<bool> is_ending{false};
  int result = status(ExitStatus::out_of_memory);
  if (is_ending.exchange(true))
    print_message("error: out of memory\n"); // even for saying so
  else
    result = std::current_exception() ? report_failure() : report(ExitStatus::internal, "internal: terminated");
  remove_leftovers();
  _exit(result);
}

[[noreturn]] void note_lack_of_memory() {
  g_memory_ran_out = true;
  throw std::bad_alloc();
}

void install() {
  std::set_terminate(end_in_failure);
  std::set_new_handler(note_lack_of_memory);
}

/// Called before the constructors of shared libraries, some of which start threads.
[[gnu::section(".preinit_array"), gnu::used]] void (*const k_install)() = install;

} // namespace

void set_activity(std::string_view activity) noexcept {
  const size_t size = std::min(activity.size(), g_activity.size() - 1);
  std::copy_n(activity.data(), size, g_activity.data());
  g_activity[size] = '\0';
}

int report_failure() noexcept {
  end_message_line();
  return report_caught();
}

} // namespace kelpie
