#include <array>
#include <bit>
#include <cstdint>

#include <fmt/format.h>

#include "field/files/text_cursor.h"
#include "field/mesh/formats.h"

namespace kelpie {

namespace {

constexpr size_t k_header = 80, k_facet = 50;

uint32_t little_endian(std::string_view bytes, size_t offset) {
  uint32_t v = 0;
  for (size_t i = 0; i < 4; ++i) v |= static_cast<uint32_t>(static_cast<unsigned char>(bytes[offset + i])) << (8 * i);
  return v;
}

void append_triangle(PolygonSoup& soup, const std::array<Vec3d, 3>& corners, int line, const std::string& file) {
  const uint32_t first = static_cast<uint32_t>(soup.positions.size());
  soup.positions.insert(soup.positions.end(), corners.begin(), corners.end());
  append_face(soup, {first, first + 1, first + 2}, line, file);
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
    std::array<Vec3d, 3> corners;
    for (size_t c = 0; c < 3; ++c)
      for (size_t k = 0; k < 3; ++k)
        corners[c][k] = std::bit_cast<float>(little_endian(bytes, k_header + 4 + k_facet * i + 4 * (3 + 3 * c + k)));
    append_triangle(soup, corners, 0, file);
  }
  return soup;
}

PolygonSoup read_ascii(std::string_view bytes, const std::string& file) {
  TextCursor text(bytes, file);
  PolygonSoup soup;
  std::array<Vec3d, 3> corners;
  size_t corner = 0;
  bool is_complete = false; // a file may hold several solids
  for (;;) {
    const std::string_view word = text.next();
    if (word.empty() && is_complete) return soup;
    if (word.empty()) text.fail("the STL file is cut off: there is no \"endsolid\"");
    if (word == "vertex") {
      if (corner == 3) text.fail("a facet with more than three vertices");
      for (int k = 0; k < 3; ++k) {
        const auto x = to_number(text.next_in_line());
        if (!x) text.fail("expected three coordinates after \"vertex\"");
        corners[corner][k] = *x;
      }
      ++corner;
    } else if (word == "endfacet") {
      if (corner != 3) text.fail("a facet with fewer than three vertices");
      append_triangle(soup, corners, text.where().line, file);
      corner = 0;
    } else if (word == "facet" || word == "endsolid" || word == "solid") {
      text.next_line(); // the normal follows from the vertices; a name does not matter
      is_complete = word == "endsolid";
    } else if (word != "outer" && word != "loop" && word != "endloop") {
      text.fail("not an ASCII STL file");
    }
  }
}

} // namespace

bool is_binary_stl(std::string_view bytes) {
  return bytes.size() > k_header + 4 && bytes.size() == k_header + 4 + k_facet * size_t{little_endian(bytes, k_header)};
}

PolygonSoup read_stl(std::string_view bytes, const std::string& file) {
  if (is_binary_stl(bytes)) return read_binary(bytes, file);
  const std::string_view head = bytes.substr(0, 1024);
  const bool is_text = bytes.substr(0, 5) == "solid" && head.find('\0') == std::string_view::npos;
  return is_text ? read_ascii(bytes, file) : read_binary(bytes, file);
}

} // namespace kelpie
