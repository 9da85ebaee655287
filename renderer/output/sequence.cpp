#include "renderer/output/sequence.h"

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <optional>
#include <string_view>
#include <unordered_set>

#include <fmt/format.h>

#include "base/error.h"

namespace kelpie {

namespace {

constexpr size_t k_most_frames = 1'000'000; // a slip of the keyboard, not a film

[[noreturn]] void wrong_range(const std::string& all, const std::string& why) {
  throw Error(ExitStatus::usage, fmt::format("frames \"{}\": {}; write 12, 1-100, 1-100x2 or a list of these: 1-96x2,100", all, why));
}

/// Takes a whole number from the front of `text`.
std::optional<int> take_number(std::string_view& text) {
  int value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc()) return {};
  text.remove_prefix(static_cast<size_t>(end - text.data()));
  return value;
}

bool take(std::string_view& text, std::string_view word) {
  if (text.substr(0, word.size()) != word) return false;
  text.remove_prefix(word.size());
  return true;
}

struct FrameRange {
  long first, last, step;
};

FrameRange parse_range(std::string_view text, const std::string& all) {
  const std::string shown(text);
  const std::optional<int> first = take_number(text);
  if (!first) wrong_range(all, shown.empty() ? "a frame is missing" : fmt::format("\"{}\" is no frame", shown));
  FrameRange range{*first, *first, 1};
  if (take(text, "..") || take(text, "-")) {
    const std::optional<int> last = take_number(text);
    if (!last) wrong_range(all, fmt::format("\"{}\" has no last frame", shown));
    range.last = *last;
    if (take(text, "x") || take(text, ":")) {
      const std::optional<int> step = take_number(text);
      if (!step || *step < 1) wrong_range(all, fmt::format("the step of \"{}\" must be 1 or more", shown));
      range.step = *step;
    }
  }
  if (!text.empty()) wrong_range(all, fmt::format("\"{}\" in \"{}\" means nothing", text, shown));
  return range;
}

} // namespace

std::vector<int> parse_frames(const std::string& ranges) {
  std::string text;
  for (const char c : ranges)
    if (c != ' ') text += c;
  if (text.empty()) wrong_range(ranges, "there are none");
  std::vector<int> frames;
  std::unordered_set<int> seen;
  for (size_t begin = 0; begin <= text.size();) {
    const size_t end = std::min(text.find(',', begin), text.size());
    const FrameRange r = parse_range(std::string_view(text).substr(begin, end - begin), ranges);
    const long step = r.first <= r.last ? r.step : -r.step, count = (r.last - r.first) / step + 1;
    if (frames.size() + static_cast<size_t>(count) > k_most_frames) wrong_range(ranges, fmt::format("more than {} frames", k_most_frames));
    for (long i = 0; i < count; ++i) {
      const int frame = static_cast<int>(r.first + i * step);
      if (seen.insert(frame).second) frames.push_back(frame);
    }
    begin = end + 1;
  }
  return frames;
}

std::string format_frames(const std::vector<int>& frames) {
  std::string text;
  for (size_t i = 0; i < frames.size();) {
    size_t end = i + 1; // of a run of even steps
    const long step = end < frames.size() ? long(frames[end]) - frames[i] : 1;
    while (end < frames.size() && long(frames[end]) - frames[end - 1] == step) ++end;
    if (end - i == 2) end = i + 1; // two frames are no run
    text += fmt::format("{}{}", text.empty() ? "" : ",", frames[i]);
    if (end - i > 1) text += fmt::format("-{}", frames[end - 1]);
    if (end - i > 1 && step > 1) text += fmt::format("x{}", step);
    i = end;
  }
  return text;
}

FramePattern::FramePattern(const std::string& text) : text_(text) {
  const size_t slash = text.rfind('/');
  size_t at = slash == std::string::npos ? 0 : slash + 1;
  std::string* part = &before_;
  before_ = text.substr(0, at);
  const auto place = [&](size_t length, int digits) {
    if (is_numbered_) throw Error(ExitStatus::usage, fmt::format("\"{}\" has two places for the frame number", text));
    is_numbered_ = true, digits_ = digits, part = &after_, at += length;
  };
  const auto number_after = [&](size_t from, size_t& end) {
    end = from;
    while (end < text.size() && text[end] >= '0' && text[end] <= '9') ++end;
    return end == from ? 1 : std::min(std::atoi(text.substr(from, std::min<size_t>(end - from, 4)).c_str()), 20);
  };
  while (at < text.size()) {
    size_t end = at;
    if (text[at] == '#') {
      end = std::min(text.find_first_not_of('#', at), text.size());
      place(end - at, static_cast<int>(std::min<size_t>(end - at, 20)));
    } else if (text.compare(at, 2, "$F") == 0) {
      const int digits = number_after(at + 2, end);
      place(end - at, digits);
    } else if (text.compare(at, 2, "%%") == 0) {
      *part += '%', at += 2;
    } else if (text[at] == '%') {
      is_filled_behind_ = text.compare(at + 1, 1, "-") == 0, sign_counts_ = true;
      const int digits = number_after(at + 1 + is_filled_behind_, end);
      if (end >= text.size() || text[end] != 'd')
        throw Error(ExitStatus::usage, fmt::format("\"{}\": after % comes a number of digits and d, as in %04d", text));
      place(end + 1 - at, digits);
    } else
      *part += text[at++];
  }
}

std::string FramePattern::path(int frame) const {
  if (!is_numbered_) return before_;
  if (is_filled_behind_) return fmt::format("{}{:<{}}{}", before_, frame, digits_, after_);
  return fmt::format("{}{:0{}}{}", before_, frame, frame < 0 && !sign_counts_ ? digits_ + 1 : digits_, after_);
}

std::vector<int> FramePattern::existing_frames() const {
  std::vector<int> frames;
  if (!is_numbered_) return frames;
  const std::filesystem::path before(before_);
  const std::filesystem::path folder = before.has_parent_path() ? before.parent_path() : std::filesystem::path(".");
  const std::string prefix = before.filename().string();
  std::error_code error;
  for (auto entry = std::filesystem::directory_iterator(folder, error); !error && entry != std::filesystem::directory_iterator();
       entry.increment(error)) {
    const std::string name = entry->path().filename().string();
    if (name.size() <= prefix.size() + after_.size() || name.compare(0, prefix.size(), prefix) != 0) continue;
    std::string_view rest(name);
    rest.remove_prefix(prefix.size());
    const std::optional<int> frame = take_number(rest);
    // The name must be the one that path() makes: `a.1.exr` is not a frame of a.####.exr.
    if (frame && std::filesystem::path(path(*frame)).filename() == name) frames.push_back(*frame);
  }
  std::sort(frames.begin(), frames.end());
  return frames;
}

void require_numbered(const FramePattern& pattern, const std::vector<int>& frames) {
  if (pattern.is_numbered() || frames.size() <= 1) return;
  throw Error(ExitStatus::usage,
              fmt::format("{} frames cannot all be written to {}; put #### where the frame number belongs, as in name.####.exr",
                          frames.size(), pattern.text()));
}

} // namespace kelpie
