#include "field/files/text_cursor.h"

#include <charconv>
#include <limits>

namespace kelpie {

void TextCursor::step_over_line_end() {
  if (at_end()) return;
  if (text_[offset_] == '\r' && offset_ + 1 < text_.size() && text_[offset_ + 1] == '\n') ++offset_;
  ++offset_;
  ++line_;
  line_start_ = offset_;
}

void TextCursor::skip_blanks() {
  while (!at_end()) {
    const char c = text_[offset_];
    if (c == ' ' || c == '\t' || c == '\v' || c == '\f') {
      ++offset_;
    } else if (comment_ && c == comment_) {
      while (!at_line_end()) ++offset_;
      return;
    } else if (continuation_ && c == continuation_ && offset_ + 1 < text_.size() &&
               (text_[offset_ + 1] == '\n' || text_[offset_ + 1] == '\r')) {
      ++offset_;
      step_over_line_end();
    } else {
      return;
    }
  }
}

std::string_view TextCursor::next_in_line() {
  skip_blanks();
  word_ = offset_, line_of_word_ = line_, line_start_of_word_ = line_start_;
  while (!at_line_end()) {
    const char c = text_[offset_];
    if (c == ' ' || c == '\t' || c == '\v' || c == '\f' || (comment_ && c == comment_)) break;
    if (continuation_ && c == continuation_ && offset_ > word_) break;
    ++offset_;
  }
  return text_.substr(word_, offset_ - word_);
}

std::string_view TextCursor::next() {
  for (;;) {
    const std::string_view word = next_in_line();
    if (!word.empty() || at_end()) return word;
    step_over_line_end();
  }
}

bool TextCursor::next_line() {
  for (;;) { // a joined line is one line
    while (!at_line_end()) ++offset_;
    const bool joined = continuation_ && offset_ > line_start_ && text_[offset_ - 1] == continuation_;
    step_over_line_end();
    if (!joined || at_end()) return !at_end();
  }
}

std::string_view TextCursor::rest_of_line() {
  skip_blanks();
  word_ = offset_, line_of_word_ = line_, line_start_of_word_ = line_start_;
  while (!at_line_end()) ++offset_;
  return text_.substr(word_, offset_ - word_);
}

std::optional<double> to_number(std::string_view word) {
  if (word.size() > 1 && word.front() == '+' && word[1] != '-') word.remove_prefix(1);
  double value = 0;
  const auto [end, code] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (word.empty() || end != word.data() + word.size()) return std::nullopt;
  if (code == std::errc::result_out_of_range) return std::numeric_limits<double>::infinity();
  return code == std::errc() ? std::optional(value) : std::nullopt;
}

std::optional<long long> to_integer(std::string_view word) {
  if (word.size() > 1 && word.front() == '+' && word[1] != '-') word.remove_prefix(1);
  long long value = 0;
  const auto [end, code] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (word.empty() || end != word.data() + word.size() || code != std::errc()) return std::nullopt;
  return value;
}

} // namespace kelpie
