#include <fmt/format.h>

#include "field/files/text_cursor.h"
#include "field/mesh/formats.h"

namespace kelpie {

namespace {

class OffReader {
public:
  OffReader(std::string_view bytes, const std::string& file) : text_(bytes, file) { text_.set_comment('#'); }

  PolygonSoup read() {
    read_header();
    for (size_t i = 0; i < vertex_count_; ++i) read_position();
    for (size_t i = 0; i < face_count_; ++i) read_face();
    return std::move(soup_);
  }

private:
  void read_header() {
    const std::string_view word = text_.next();
    if (word.size() < 3 || word.substr(word.size() - 3) != "OFF") text_.fail("not an OFF file: it does not begin with \"OFF\"");
    const std::string_view prefix = word.substr(0, word.size() - 3);
    if (prefix.find_first_not_of("STCN") != std::string_view::npos)
      text_.fail("this variant of OFF is not supported (four or n dimensions)");
    has_extras_ = !prefix.empty();
    vertex_count_ = read_count("vertices", 6); // "0 0 0\n"
    face_count_ = read_count("faces", 4);      // "1 0\n"
    text_.next_line();                         // the count of edges is never right and never needed
    if (face_count_ > k_most_faces) text_.fail(fmt::format("{} faces are more than the limit of {}", face_count_, k_most_faces));
    soup_.positions.reserve(vertex_count_);
  }

  size_t read_count(const char* what, size_t fewest_bytes) {
    const auto n = to_integer(text_.next());
    if (!n || *n < 0) text_.fail(fmt::format("expected the number of {}", what));
    if (static_cast<size_t>(*n) > (text_.remaining() + 1) / fewest_bytes)
      text_.fail(fmt::format("{} {} are promised, but only {} bytes follow", *n, what, text_.remaining()));
    return static_cast<size_t>(*n);
  }

  std::string_view next_or_fail() {
    const std::string_view word = text_.next();
    if (word.empty()) text_.fail("the OFF file is cut off");
    return word;
  }

  void read_position() {
    Vec3d p;
    for (int k = 0; k < 3; ++k) {
      const auto x = to_number(next_or_fail());
      if (!x) text_.fail("expected a coordinate");
      p[k] = *x;
    }
    soup_.positions.push_back(p);
    if (has_extras_) text_.next_line();
  }

  void read_face() {
    const auto n = to_integer(next_or_fail());
    const int line = text_.where().line;
    if (!n || *n < 0) text_.fail("expected the number of a face's corners");
    if (static_cast<size_t>(*n) > (text_.remaining() + 1) / 2) text_.fail(fmt::format("a face of {} corners is longer than the file", *n));
    corners_.clear();
    for (long long i = 0; i < *n; ++i) {
      const auto index = to_integer(next_or_fail());
      if (!index) text_.fail("expected the index of a vertex");
      if (*index < 0 || static_cast<size_t>(*index) >= vertex_count_)
        text_.fail(fmt::format("there is no vertex {}: the file has {}", *index, vertex_count_));
      corners_.push_back(static_cast<uint32_t>(*index));
    }
    append_face(soup_, corners_, line, text_.file());
    text_.next_line(); // a colour may follow
  }

  TextCursor text_;
  PolygonSoup soup_;
  std::vector<uint32_t> corners_;
  size_t vertex_count_ = 0, face_count_ = 0;
  bool has_extras_ = false;
};

} // namespace

PolygonSoup read_off(std::string_view bytes, const std::string& file) { return OffReader(bytes, file).read(); }

} // namespace kelpie
