#include "cli/progress.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>

#include <sys/ioctl.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "base/standard_streams.h"

namespace kelpie {

namespace {

bool stderr_is_a_terminal() {
  const char* terminal = std::getenv("TERM");
  return isatty(STDERR_FILENO) && !(terminal && std::string_view(terminal) == "dumb");
}

size_t terminal_width() {
  winsize size{};
  return ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 20 ? size.ws_col : 80;
}

std::string format_left(double seconds) { return seconds < 0 ? "" : ", " + format_duration(seconds) + " left"; }

} // namespace

ProgressMode shown_as(ProgressMode mode) {
  if (mode != ProgressMode::automatic) return mode;
  return stderr_is_a_terminal() ? ProgressMode::bar : ProgressMode::plain;
}

void add_progress_option(CLI::App& app, ProgressMode& mode) {
  static const std::map<std::string, ProgressMode> names{{"auto", ProgressMode::automatic},
                                                         {"bar", ProgressMode::bar},
                                                         {"plain", ProgressMode::plain},
                                                         {"jsonl", ProgressMode::jsonl},
                                                         {"none", ProgressMode::none}};
  const auto to_number = [](std::string& text) {
    const auto found = names.find(text);
    if (found == names.end()) return fmt::format("must be auto, bar, plain, jsonl or none, found {}", text);
    text = std::to_string(static_cast<int>(found->second));
    return std::string();
  };
  app.add_option("--progress", mode, "progress on stderr: auto (a bar on a terminal, lines otherwise), bar, plain, jsonl or none [auto]")
      ->transform(CLI::Validator(to_number, ""))
      ->option_text("MODE");
}

std::string format_duration(double seconds) {
  const long s = std::lround(std::clamp(seconds, 0.0, 3.6e8));
  if (s < 3600) return fmt::format("{}:{:02}", s / 60, s % 60);
  return fmt::format("{}:{:02}:{:02}", s / 3600, s / 60 % 60, s % 60);
}

Progress::Progress(ProgressMode mode, double total, std::string unit) : mode_(shown_as(mode)), total_(total), unit_(std::move(unit)) {
  if (!(total_ > 0)) mode_ = ProgressMode::none;
}

Progress::~Progress() {
  if (bar_is_drawn_) end_message_line();
}

void Progress::advance(double done, const std::string& message) {
  const std::lock_guard lock(mutex_);
  if (mode_ == ProgressMode::none) return;
  done_ = std::clamp(done, done_, total_);
  if (!message.empty()) message_ = message;
  const Clock::time_point now = Clock::now();
  const std::chrono::duration<double> pause(mode_ == ProgressMode::bar ? 0.1 : mode_ == ProgressMode::jsonl ? 0.5 : 30.0);
  const bool is_due = now - last_shown_ >= pause && (mode_ != ProgressMode::plain || now - start_ >= pause);
  if (!is_due && message.empty() && done_ < total_) return;
  if (!is_due && mode_ == ProgressMode::bar && done_ < total_) return; // it shows the latest message when it is due
  if (mode_ == ProgressMode::plain && message.empty() && !is_due) return;
  last_shown_ = now;
  const double elapsed = std::chrono::duration<double>(now - start_).count();
  const double left = done_ > 0 ? elapsed * (total_ - done_) / done_ : -1;
  if (mode_ == ProgressMode::bar) draw_bar(left);
  if (mode_ == ProgressMode::plain) write_line(left);
  if (mode_ == ProgressMode::jsonl) write_object(left);
}

void Progress::draw_bar(double left) {
  const size_t width = terminal_width();
  const int filled = static_cast<int>(24 * done_ / total_);
  std::string line = fmt::format("[{:-<24}] {:3.0f}%  {:.0f}/{:.0f} {}{}", std::string(filled, '#'), std::floor(100 * done_ / total_),
                                 std::floor(done_), total_, unit_, done_ < total_ ? format_left(left) : "");
  if (!message_.empty()) line += "  " + message_;
  line.resize(std::min(line.size(), width - 1));
  print_message(fmt::format("\r{}\x1b[K", line));
  bar_is_drawn_ = true;
}

void Progress::write_line(double left) {
  print_message(fmt::format("{:.0f}/{:.0f} {} ({:.0f}%{}){}{}\n", std::floor(done_), total_, unit_, std::floor(100 * done_ / total_),
                            done_ < total_ ? format_left(left) : "", message_.empty() ? "" : ": ", message_));
  message_.clear();
}

void Progress::write_object(double left) {
  nlohmann::ordered_json object{{"done", done_}, {"total", total_}, {"unit", unit_}};
  if (left >= 0) object["left_s"] = std::round(left * 10) / 10;
  if (!message_.empty()) object["message"] = message_;
  print_message(object.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n");
  message_.clear();
}

void Progress::print_line(const std::string& line) {
  const std::lock_guard lock(mutex_);
  print_message(fmt::format("{}{}\n", bar_is_drawn_ ? "\r\x1b[K" : "", line));
  bar_is_drawn_ = false;
}

} // namespace kelpie
