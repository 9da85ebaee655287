#include "cli/heartbeat.h"

#include <cmath>
#include <condition_variable>
#include <system_error>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "base/standard_streams.h"

namespace kelpie {

namespace {

std::string beat_text(ProgressMode mode, const std::string& activity, double seconds) {
  if (mode == ProgressMode::bar) return fmt::format("\r{}, for {}\x1b[K", activity, format_duration(seconds));
  if (mode == ProgressMode::plain) return fmt::format("{}, for {}\n", activity, format_duration(seconds));
  const nlohmann::ordered_json object{{"activity", activity}, {"for_s", std::round(seconds)}};
  return object.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

void beat(const std::stop_token& stop, ProgressMode mode, const std::string& activity) {
  const std::chrono::seconds pause(mode == ProgressMode::bar ? 1 : 30);
  std::mutex mutex;
  std::unique_lock lock(mutex);
  std::condition_variable_any nothing; // only a stop wakes it
  int beats = 0;
  while (!nothing.wait_for(lock, stop, pause, [&] { return stop.stop_requested(); }))
    print_message(beat_text(mode, activity, double(++beats * pause.count())));
  if (mode == ProgressMode::bar && beats > 0) print_message("\r\x1b[K");
}

} // namespace

Heartbeat::Heartbeat(ProgressMode mode, std::string activity) {
  mode = shown_as(mode);
  if (mode == ProgressMode::none) return;
  try {
    thread_ = std::jthread([mode, activity = std::move(activity)](const std::stop_token& stop) { beat(stop, mode, activity); });
  } catch (const std::system_error&) {
    // No memory for its stack: the work itself may still fit.
  }
}

void Heartbeat::stop() {
  std::call_once(stopped_, [&] { thread_ = {}; });
}

} // namespace kelpie
