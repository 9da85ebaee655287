// Reads text word by word and knows where it stands.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "base/error.h"

namespace kelpie {

/// The text without what some programs put around it: a byte order mark before it, NUL and Ctrl-Z (0x1A, the end of a file under
/// CP/M and DOS) behind it. Throws Error, bad_data, where it is UTF-16.
std::string_view without_padding(std::string_view text, const std::string& file);

/// A forward-only cursor over text that outlives it. Lines end in \n, \r or \r\n; blanks are spaces and
/// tabs. Positions count lines and columns (bytes) from 1.
class TextCursor {
public:
  TextCursor(std::string_view text, std::string file) : text_(text), file_(std::move(file)) {}

  /// A character that makes the rest of its line a comment (0: none; it makes none behind a point, as in 1.#QNAN), and one that
  /// joins a line to the next where it ends the line (0: none). A comment ends with its line, whatever its last character.
  void set_comment(char c) { comment_ = c; }
  void set_continuation(char c) { continuation_ = c; }

  /// The next word of this line, which goes on where lines are joined; empty at its end.
  std::string_view next_in_line();
  /// The next word, on this line or a later one; empty at the end of the text.
  std::string_view next();
  /// Goes to the beginning of the next line; false at the end of the text.
  bool next_line();
  /// The rest of this line, without its end. Neither comments nor joined lines are recognised.
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
  bool begins_comment() const { return comment_ && text_[offset_] == comment_ && (offset_ == word_ || text_[offset_ - 1] != '.'); }
  bool at_line_end() const { return at_end() || text_[offset_] == '\n' || text_[offset_] == '\r'; }
  void step_over_line_end();

  std::string_view text_;
  std::string file_;
  char comment_ = 0, continuation_ = 0;
  size_t offset_ = 0, line_start_ = 0, word_ = 0, line_start_of_word_ = 0;
  int line_ = 1, line_of_word_ = 1;
};

/// The number that `word` is, whole. What is too small for a double is 0, what is too large infinite; `nan` and `inf` are numbers too,
/// also as Microsoft's C library writes them (-1.#IND00, 1.#INF).
std::optional<double> to_number(std::string_view word);
/// The whole number that `word` is.
std::optional<long long> to_integer(std::string_view word);

/// The word with a to z for A to Z: keywords are written either way.
std::string lower_case(std::string_view word);

} // namespace kelpie
