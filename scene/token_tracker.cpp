#include "scene/token_tracker.h"

#include <string_view>

namespace kelpie {

namespace {
bool is_one_of(std::string_view set, unsigned char c) { return set.find(static_cast<char>(c)) != std::string_view::npos; }
bool is_space(unsigned char c) { return is_one_of(" \t\r\n", c); }
bool ends_word(unsigned char c) { return is_space(c) || is_one_of("{}[],:\"/", c); }
} // namespace

bool TokenTracker::is_word(const Token& t) { return !ends_word(t.first); }

void TokenTracker::consume(unsigned char c) {
  last_ = next_;
  switch (state_) {
  case State::word:
    if (!ends_word(c)) break;
    [[fallthrough]];
  case State::between:
    if (is_space(c))
      state_ = State::between;
    else if (c == '"')
      begin_token(c, State::string);
    else if (c == '/')
      begin_token(c, State::slash);
    else
      begin_token(c, ends_word(c) ? State::between : State::word);
    break;
  case State::string: state_ = c == '"' ? State::between : c == '\\' ? State::escape : State::string; break;
  case State::escape: state_ = State::string; break;
  case State::slash: state_ = c == '*' ? State::block_comment : State::line_comment; break;
  case State::line_comment: state_ = c == '\n' ? State::between : State::line_comment; break;
  case State::block_comment: state_ = c == '*' ? State::block_star : State::block_comment; break;
  case State::block_star: state_ = c == '/' ? State::between : c == '*' ? State::block_star : State::block_comment; break;
  }
  advance(c);
}

void TokenTracker::begin_token(unsigned char c, State then) {
  previous_ = token_;
  token_ = {next_, c};
  state_ = then;
}

void TokenTracker::advance(unsigned char c) {
  if (c == '\n')
    ++next_.line, next_.column = 1;
  else if ((c & 0xC0) != 0x80) // the further bytes of a UTF-8 character stand in the same column
    ++next_.column;
}

} // namespace kelpie
