#include "field/files/text_cursor.h"

#include <algorithm>
#include <charconv>
#include <limits>

namespace kelpie {

std::string_view without_padding(std::string_view text, const std::string& file) {
  using namespace std::string_view_literals;
  if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);
  if (text.starts_with("\xff\xfe") || text.starts_with("\xfe\xff"))
    throw Error(ExitStatus::bad_data, "the text is UTF-16: save it as ASCII or UTF-8", {file, 0, 0});
  const size_t last = text.find_last_not_of("\0\x1a"sv);
  return text.substr(0, last == std::string_view::npos ? 0 : last + 1);
}

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
    if (c == ' ' || c == '\t' || c == '\v' || c == '\f' || begins_comment()) break;
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
  while (!next_in_line().empty()) {
  }
  step_over_line_end();
  return !at_end();
}

std::string_view TextCursor::rest_of_line() {
  skip_blanks();
  word_ = offset_, line_of_word_ = line_, line_start_of_word_ = line_start_;
  while (!at_line_end()) ++offset_;
  return text_.substr(word_, offset_ - word_);
}

namespace {

/// Of a decimal number that is out of range: whether it is too small, not too large.
bool is_too_small(std::string_view word) {
  const size_t e = std::min(word.find_first_of("eE"), word.size());
  const std::string_view digits = word.substr(0, e);
  const size_t point = std::min(digits.find('.'), e), first = std::min(digits.find_first_of("123456789"), e);
  // The power of ten of the first digit; more than a million is more than any file has digits.
  const double power = first < point ? static_cast<double>(point - first) : -static_cast<double>(first - point);
  std::string_view exponent = word.substr(std::min(e + 1, word.size()));
  const bool is_negative = exponent.starts_with('-');
  exponent.remove_prefix(exponent.empty() ? 0 : std::min(exponent.find_first_not_of("+-0"), exponent.size()));
  double value = 0;
  for (const char c : exponent) value = std::min(10 * value + (c - '0'), 1e12);
  return power + (is_negative ? -value : value) < 0;
}

/// Microsoft's C library writes a digit, `.#`, one of these, and digits.
std::optional<double> special_number(std::string_view word) {
  const size_t mark = word.find(".#");
  if (mark == std::string_view::npos) return std::nullopt;
  const std::string name = lower_case(word.substr(mark + 2));
  if (name.starts_with("inf")) return (word.starts_with('-') ? -1 : 1) * std::numeric_limits<double>::infinity();
  for (const char* other : {"ind", "qnan", "snan", "nan"})
    if (name.starts_with(other)) return std::numeric_limits<double>::quiet_NaN();
  return std::nullopt;
}

} // namespace

std::optional<double> to_number(std::string_view word) {
  if (word.size() > 1 && word.front() == '+' && word[1] != '-') word.remove_prefix(1);
  double value = 0;
  const auto [end, code] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (word.empty() || end != word.data() + word.size()) return special_number(word);
  if (code == std::errc::result_out_of_range) {
    if (is_too_small(word)) return 0.0;
    return (word.front() == '-' ? -1 : 1) * std::numeric_limits<double>::infinity();
  }
  return code == std::errc() ? std::optional(value) : std::nullopt;
}

std::optional<long long> to_integer(std::string_view word) {
  if (word.size() > 1 && word.front() == '+' && word[1] != '-') word.remove_prefix(1);
  long long value = 0;
  const auto [end, code] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (word.empty() || end != word.data() + word.size() || code != std::errc()) return std::nullopt;
  return value;
}

std::string lower_case(std::string_view word) {
  std::string s(word);
  for (char& c : s) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return s;
}

} // namespace kelpie
