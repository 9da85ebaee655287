#include <fmt/format.h>

#include "field/mesh/formats.h"

namespace kelpie {

namespace {

/// Where `off` begins in the first word of a file, lower case: behind letters that say what vertices have besides their position, before
/// nothing or the first count (OFF642). npos: it is no such word.
size_t off_in_header(std::string_view word) {
  const size_t off = word.find("off");
  const bool is_header = off != std::string_view::npos && std::min(word.find_first_not_of("stcn4"), word.size()) >= off &&
                         word.find_first_not_of("0123456789", off + 3) == std::string_view::npos;
  return is_header ? off : std::string_view::npos;
}

class OffReader {
public:
  OffReader(std::string_view bytes, const std::string& file) : text_(without_padding(bytes, file), file) { text_.set_comment('#'); }

  PolygonSoup read() {
    read_counts(read_header());
    soup_.positions.reserve(vertex_count_);
    const bool is_by_lines = count_lines() >= vertex_count_ + face_count_;
    for (size_t i = 0; i < vertex_count_; ++i) read_vertex(is_by_lines);
    for (size_t i = 0; i < face_count_; ++i) read_face();
    return std::move(soup_);
  }

private:
  /// Returns what of the counts is part of the header's word. The word may be missing.
  std::string_view read_header() {
    const TextCursor begin = text_;
    const std::string_view word = text_.next();
    if (to_integer(word)) {
      text_ = begin;
      return {};
    }
    const std::string letters = lower_case(word);
    const size_t off = off_in_header(letters);
    if (off == std::string::npos) text_.fail("not an OFF file: it does not begin with \"OFF\"");
    const std::string_view prefix = std::string_view(letters).substr(0, off);
    if (prefix.find('4') != std::string_view::npos || word.substr(0, off + 3).ends_with("nOFF"))
      text_.fail("this variant of OFF is not supported (four or n dimensions)");
    for (const auto& [letter, numbers] : {std::pair{'n', 3}, {'c', 4}, {'t', 2}}) // normal, colour, texture coordinates
      if (prefix.find(letter) != std::string_view::npos) extras_ += numbers;
    TextCursor ahead = text_;
    if (lower_case(ahead.next_in_line()) == "binary") ahead.fail("binary OFF files are not supported");
    return word.substr(off + 3);
  }

  void read_counts(std::string_view first) {
    vertex_count_ = read_count(first.empty() ? text_.next() : first, "vertices", 6); // "0 0 0\n"
    const int line = text_.where().line;
    face_count_ = read_count(text_.next(), "faces", 4); // "1 0\n"
    if (face_count_ > k_most_faces) text_.fail(fmt::format("{} faces are more than the limit of {}", face_count_, k_most_faces));
    // The number of edges is never right and never needed; in the counts' line it may be missing.
    if (text_.where().line == line)
      text_.next_line();
    else
      text_.next();
  }

  size_t read_count(std::string_view word, const char* what, size_t fewest_bytes) {
    const auto n = to_integer(word);
    if (!n || *n < 0) text_.fail(fmt::format("expected the number of {}", what));
    if (static_cast<size_t>(*n) > (text_.remaining() + 1) / fewest_bytes)
      text_.fail(fmt::format("{} {} are promised, but only {} bytes follow", *n, what, text_.remaining()));
    return static_cast<size_t>(*n);
  }

  /// Of the lines that follow, those that are neither empty nor a comment.
  size_t count_lines() const {
    TextCursor ahead = text_;
    size_t lines = 0;
    do lines += !ahead.next_in_line().empty();
    while (ahead.next_line());
    return lines;
  }

  /// Where each vertex has a line of its own, it may have anything behind its position: colours are found in files that do not say so.
  void read_vertex(bool is_by_lines) {
    read_position(text_, &TextCursor::next, "expected a coordinate", soup_);
    if (is_by_lines)
      text_.next_line();
    else
      for (int k = 0; k < extras_; ++k) text_.next();
  }

  long long next_integer(const char* expected) {
    const std::string_view word = text_.next();
    const auto n = to_integer(word);
    if (!n) text_.fail(fmt::format("{}{}", word.empty() ? "the file is cut off: " : "", expected));
    return *n;
  }

  void read_face() {
    const long long n = next_integer("expected the number of a face's corners");
    const int line = text_.where().line;
    if (n < 0) text_.fail("expected the number of a face's corners");
    if (static_cast<size_t>(n) > (text_.remaining() + 1) / 2) text_.fail(fmt::format("a face of {} corners is longer than the file", n));
    corners_.clear();
    for (long long i = 0; i < n; ++i) {
      const long long index = next_integer("expected the index of a vertex");
      if (index < 0 || static_cast<size_t>(index) >= vertex_count_)
        text_.fail(fmt::format("there is no vertex {}: the file has {}", index, vertex_count_));
      corners_.push_back(static_cast<uint32_t>(index));
    }
    append_face(soup_, corners_, line, text_.file());
    text_.next_line(); // a colour may follow
  }

  TextCursor text_;
  PolygonSoup soup_;
  std::vector<uint32_t> corners_;
  size_t vertex_count_ = 0, face_count_ = 0;
  int extras_ = 0; ///< numbers of a vertex besides its position, by the header
};

} // namespace

bool is_off_header(std::string_view word) { return off_in_header(lower_case(word)) != std::string::npos; }

PolygonSoup read_off(std::string_view bytes, const std::string& file) { return OffReader(bytes, file).read(); }

} // namespace kelpie
