// A sign of life from work of which nobody knows how long it will take.
#pragma once

#include <mutex>
#include <string>
#include <thread>

#include "cli/progress.h"

namespace kelpie {

/// While it lives, says on stderr what goes on and for how long already ("reading shot.json, for 0:30"): on a bar's line every second, as
/// lines and objects every half minute.
class Heartbeat {
public:
  Heartbeat(ProgressMode, std::string activity);
  ~Heartbeat() { stop(); }
  Heartbeat(const Heartbeat&) = delete;
  Heartbeat& operator=(const Heartbeat&) = delete;

  /// From now on it is silent. By any thread, as often as is wanted.
  void stop();

private:
  std::once_flag stopped_;
  std::jthread thread_;
};

} // namespace kelpie
