// Where in a text the tokens begin.
#pragma once

#include "scene/document.h"

namespace kelpie {

/// Follows the characters that a JSON lexer consumes, because a lexer that calls back at the end of a
/// token does not say where it began. Knows just enough of JSON with comments to tell tokens apart.
class TokenTracker {
public:
  /// `source`: of all positions.
  explicit TokenTracker(std::uint32_t source) : next_{1, 1, source}, last_(next_) {}

  void consume(unsigned char c);

  /// The character to come.
  TextPosition next() const { return next_; }
  /// The character consumed last.
  TextPosition last() const { return last_; }
  /// The token consumed last.
  TextPosition token() const { return token_.at; }
  /// The number or literal consumed last: its end is seen only at the character behind it, which may
  /// begin a token itself.
  TextPosition word() const { return is_word(token_) ? token_.at : previous_.at; }

  /// Whether the tokens consumed last are a comma and a closing bracket.
  bool is_closing_behind_comma() const { return previous_.first == ',' && (token_.first == '}' || token_.first == ']'); }

private:
  struct Token {
    TextPosition at;
    unsigned char first = 0;
  };
  enum class State { between, word, string, escape, slash, line_comment, block_comment, block_star };

  static bool is_word(const Token&);
  void begin_token(unsigned char c, State then);
  void advance(unsigned char c);

  TextPosition next_, last_;
  Token token_, previous_;
  State state_ = State::between;
};

} // namespace kelpie
