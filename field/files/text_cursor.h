// Reads text word by word and knows where it stands.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "base/error.h"

namespace kelpie {

/// A forward-only cursor over text that outlives it. Lines end in \n, \r or \r\n; blanks are spaces and
/// tabs. Positions count lines and columns (bytes) from 1.
class TextCursor {
public:
  TextCursor(std::string_view text, std::string file) : text_(text), file_(std::move(file)) {}

  /// A character that makes the rest of its line a comment (0: none), and one that joins a line to
  /// the next where it ends the line (0: none).
  void set_comment(char c) { comment_ = c; }
  void set_continuation(char c) { continuation_ = c; }

  /// The next word of this line; empty at its end. Never leaves the line.
  std::string_view next_in_line();
  /// The next word, on this line or a later one; empty at the end of the text.
  std::string_view next();
  /// Goes to the beginning of the next line; false at the end of the text.
  bool next_line();
  /// The rest of this line, without its end. A comment is not recognised.
  std::string_view rest_of_line();

  bool at_end() const { return offset_ >= text_.size(); }
  size_t offset() const { return offset_; }
  size_t remaining() const { return text_.size() - offset_; }

  /// Where the last word began.
  SourcePosition where() const { return {file_, line_of_word_, static_cast<int>(word_ - line_start_of_word_) + 1}; }
  const std::string& file() const { return file_; }
  [[noreturn]] void fail(const std::string& message) const { throw Error(ExitStatus::bad_data, message, where()); }

private:
  void skip_blanks();
  bool at_line_end() const { return at_end() || text_[offset_] == '\n' || text_[offset_] == '\r'; }
  void step_over_line_end();

  std::string_view text_;
  std::string file_;
  char comment_ = 0, continuation_ = 0;
  size_t offset_ = 0, line_start_ = 0, word_ = 0, line_start_of_word_ = 0;
  int line_ = 1, line_of_word_ = 1;
};

/// The number that `word` is, whole; overflow yields infinity, and `nan` and `inf` are numbers too.
std::optional<double> to_number(std::string_view word);
/// The whole number that `word` is.
std::optional<long long> to_integer(std::string_view word);

} // namespace kelpie
