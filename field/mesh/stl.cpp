#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>

#include <fmt/format.h>

#include "field/mesh/formats.h"

namespace kelpie {

namespace {

constexpr size_t k_header = 80, k_facet = 50;

uint32_t little_endian(std::string_view bytes, size_t offset) {
  uint32_t v = 0;
  for (size_t i = 0; i < 4; ++i) v |= static_cast<uint32_t>(static_cast<unsigned char>(bytes[offset + i])) << (8 * i);
  return v;
}

/// Whether the size is exactly that which the count of a binary file calls for. (Binary files may begin with "solid" as well.)
bool has_binary_size(std::string_view bytes) {
  return bytes.size() > k_header + 4 && bytes.size() == k_header + 4 + k_facet * size_t{little_endian(bytes, k_header)};
}

/// Text has no NUL but behind its end.
bool is_text(std::string_view bytes) {
  const size_t nul = bytes.find('\0');
  return nul == std::string_view::npos || bytes.find_first_not_of(std::string_view("\0\x1a", 2), nul) == std::string_view::npos;
}

/// Whether text begins with `solid`, which its name may follow at once.
bool begins_with_solid(std::string_view bytes) {
  if (bytes.starts_with("\xef\xbb\xbf")) bytes.remove_prefix(3);
  TextCursor text(bytes, "");
  text.set_comment('#');
  return lower_case(text.next().substr(0, 5)) == "solid";
}

/// The facet made of the last three positions.
void append_facet(PolygonSoup& soup, int line, const std::string& file) {
  const uint32_t end = static_cast<uint32_t>(soup.positions.size());
  append_face(soup, {end - 3, end - 2, end - 1}, line, file);
}

PolygonSoup read_binary(std::string_view bytes, const std::string& file) {
  if (bytes.size() < k_header + 4) throw Error(ExitStatus::bad_data, "the STL file is cut off before its first facet", {file, 0, 0});
  const size_t count = little_endian(bytes, k_header), room = (bytes.size() - k_header - 4) / k_facet;
  if (count > room)
    throw Error(ExitStatus::bad_data, fmt::format("the STL file is cut off: {} facets are promised, {} follow", count, room), {file, 0, 0});
  if (count == 0)
    throw Error(ExitStatus::bad_data,
                fmt::format("the STL file states that it has no facets, but {} bytes follow", bytes.size() - k_header - 4), {file, 0, 0});
  if (count > k_most_faces)
    throw Error(ExitStatus::bad_data, fmt::format("{} facets are more than the limit of {}", count, k_most_faces), {file, 0, 0});
  PolygonSoup soup;
  soup.positions.reserve(3 * count);
  for (size_t i = 0; i < count; ++i) {
    for (size_t c = 0; c < 3; ++c) {
      Vec3d p;
      for (size_t k = 0; k < 3; ++k) p[k] = std::bit_cast<float>(little_endian(bytes, k_header + 4 + k_facet * i + 4 * (3 + 3 * c + k)));
      append_position(soup, p, [&] { return SourcePosition{file, 0, 0}; });
    }
    append_facet(soup, 0, file);
  }
  return soup;
}

/// What ASCII files are made of: solid NAME, then facets (facet normal NX NY NZ, outer loop, three times vertex X Y Z, endloop, endfacet),
/// then endsolid NAME; more solids may follow.
class AsciiReader {
public:
  AsciiReader(std::string_view bytes, const std::string& file) : text_(without_padding(bytes, file), file) { text_.set_comment('#'); }

  PolygonSoup read() {
    bool is_complete = false;
    for (;;) {
      const std::string word = next_keyword();
      if (word.empty() && is_complete) return std::move(soup_);
      if (word.empty()) text_.fail("the STL file is cut off: there is no \"endsolid\"");
      if (word == "vertex") {
        if (corners_++ == 3) text_.fail("a facet with more than three vertices");
        read_position(text_, &TextCursor::next_in_line, "expected three coordinates after \"vertex\"", soup_);
      } else if (word == "endfacet") {
        if (corners_ != 3) text_.fail("a facet with fewer than three vertices");
        append_facet(soup_, text_.where().line, text_.file());
        corners_ = 0;
      } else if (word.starts_with("endsolid") || word.starts_with("solid") || word == "color") {
        text_.rest_of_line(); // names and colours do not matter
        is_complete = word.starts_with("endsolid");
      } else if (word.starts_with("facet")) {
        skip_normal();
      } else if (word != "outer" && word != "loop" && word != "outerloop" && word != "endloop") {
        text_.fail("not an ASCII STL file: expected \"facet\", \"outer loop\", \"vertex\", \"endloop\", \"endfacet\" or \"endsolid\"");
      }
    }
  }

private:
  /// The next keyword in lower case; `end` is a part of the one that follows it.
  std::string next_keyword() {
    std::string word = lower_case(text_.next());
    if (word == "end") word += lower_case(text_.next_in_line());
    return word;
  }

  /// It follows from the vertices, and need not be a number.
  void skip_normal() {
    for (TextCursor ahead = text_;;) {
      const std::string word = lower_case(ahead.next());
      if (word.empty() || word.starts_with("outer") || word == "loop" || word == "vertex" || word.starts_with("end")) return;
      text_ = ahead;
    }
  }

  TextCursor text_;
  PolygonSoup soup_;
  int corners_ = 0; ///< of the facet that is being read
};

} // namespace

bool is_stl(std::string_view bytes) {
  if (has_binary_size(bytes)) return true;
  return begins_with_solid(bytes) && (!is_text(bytes) || lower_case(bytes.substr(0, 1 << 16)).find("facet") != std::string::npos);
}

PolygonSoup read_stl(std::string_view bytes, const std::string& file) {
  if (has_binary_size(bytes) || !is_text(bytes)) return read_binary(bytes, file);
  if (!begins_with_solid(bytes))
    throw Error(ExitStatus::bad_data, "neither a binary STL file (it is text), nor an ASCII one (it does not begin with \"solid\")",
                {file, 1, 1});
  return AsciiReader(bytes, file).read();
}

} // namespace kelpie
