// How far a command is, on stderr.
#pragma once

#include <chrono>
#include <mutex>
#include <string>

namespace CLI {
class App;
}

namespace kelpie {

enum class ProgressMode {
  automatic, ///< a bar on a terminal, plain lines otherwise
  bar,       ///< one line, redrawn, with the time left
  plain,     ///< a line a message, for logs
  jsonl,     ///< one JSON object a line, for programs
  none,
};

/// What `automatic` means for stderr as it is; any other mode stays.
ProgressMode shown_as(ProgressMode);

/// Adds `--progress=auto|bar|plain|jsonl|none`.
void add_progress_option(CLI::App&, ProgressMode&);

/// Reports work of a known amount. May be called from any thread; calls are cheap (the bar is redrawn ten
/// times a second at most). The destructor ends the bar's line, so messages printed later start on their own.
class Progress {
public:
  /// `total` units of work, named in the plural ("frames"); 0 or less reports nothing.
  Progress(ProgressMode, double total, std::string unit);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// `done` of the total, which may be fractional and does not go back. A message ("wrote a.0012.exr") is
  /// always shown; without one, lines and objects are written every now and then only.
  void advance(double done, const std::string& message = {});

  /// A line of its own on stderr (a warning, say) that does not run into the bar.
  void print_line(const std::string& line);

private:
  using Clock = std::chrono::steady_clock;

  void draw_bar(double seconds_left);
  void write_line(double seconds_left);
  void write_object(double seconds_left);

  ProgressMode mode_;
  double total_, done_ = 0;
  std::string unit_, message_;
  Clock::time_point start_ = Clock::now(), last_shown_{};
  bool bar_is_drawn_ = false;
  std::mutex mutex_;
};

/// `0:42`, `12:05`, `3:07:00`.
std::string format_duration(double seconds);

} // namespace kelpie
