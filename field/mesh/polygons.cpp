// What all formats of meshes have in common.
#include <algorithm>
#include <filesystem>

#include <fmt/format.h>

#include "field/mesh/formats.h"
#include "field/mesh/triangulate.h"

namespace kelpie {

namespace {

/// The first word that is no comment.
std::string first_word(std::string_view bytes) {
  if (bytes.starts_with("\xef\xbb\xbf")) bytes.remove_prefix(3);
  TextCursor text(bytes, "");
  text.set_comment('#');
  return std::string(text.next().substr(0, 16));
}

/// Positions that faces use must be places; the others are moved to where they do no harm.
void check_positions(PolygonSoup& soup) {
  if (soup.unusable.empty()) return;
  std::vector<char> is_used(soup.positions.size(), 0);
  for (const uint32_t c : soup.corners) is_used[c] = 1;
  const auto spare = std::find(is_used.begin(), is_used.end(), char{1});
  for (const auto& [vertex, where] : soup.unusable) {
    const Vec3d& p = soup.positions[vertex];
    if (is_used[vertex])
      throw Error(ExitStatus::bad_data,
                  fmt::format("{}a face uses this vertex, but it is at ({}, {}, {}): not finite, or beyond {:g}",
                              where.line ? "" : fmt::format("vertex {}: ", vertex), p.x, p.y, p.z, k_farthest),
                  where);
    soup.positions[vertex] = spare == is_used.end() ? Vec3d(0) : soup.positions[static_cast<size_t>(spare - is_used.begin())];
  }
}

PolygonSoup read_by_format(std::string_view bytes, const std::string& path, Diagnostics& diagnostics) {
  const std::string extension = lower_case(std::filesystem::path(path).extension().string());
  const std::string first = first_word(bytes);
  if (is_ply(bytes)) return read_ply_mesh(bytes, path);
  if (is_off_header(first)) return read_off(bytes, path);
  if (is_stl(bytes)) return read_stl(bytes, path);
  without_padding(bytes, path); // throws where the text is in no encoding that is read
  if (extension == ".ply") return read_ply_mesh(bytes, path);
  if (extension == ".off") return read_off(bytes, path);
  if (extension == ".stl") return read_stl(bytes, path);
  const std::string word = lower_case(first);
  if (extension == ".obj" || word == "v" || word == "o" || word == "g" || word == "mtllib" || bytes[0] == '#')
    return read_obj(bytes, path, diagnostics);
  throw Error(ExitStatus::bad_data, "neither OBJ, PLY, OFF nor STL", {path, 0, 0});
}

} // namespace

PolygonSoup read_polygons(std::string_view bytes, const std::string& path, Diagnostics& diagnostics) {
  if (bytes.empty()) throw Error(ExitStatus::bad_data, "the file is empty", {path, 0, 0});
  PolygonSoup soup = read_by_format(bytes, path, diagnostics);
  check_positions(soup);
  return soup;
}

void append_face(PolygonSoup& soup, const std::vector<uint32_t>& corners, int line, const std::string& file) {
  if (soup.face_count() >= k_most_faces)
    throw Error(ExitStatus::bad_data, fmt::format("more faces than the limit of {}", k_most_faces), {file, line, 0});
  soup.corners.insert(soup.corners.end(), corners.begin(), corners.end());
  soup.face_ends.push_back(soup.corners.size());
  if (line) soup.lines.push_back(line);
}

void read_position(TextCursor& text, std::string_view (TextCursor::*next)(), std::string_view expected, PolygonSoup& soup) {
  Vec3d p;
  SourcePosition where;
  for (int k = 0; k < 3; ++k) {
    const std::string_view word = (text.*next)();
    const auto x = to_number(word);
    if (!x) text.fail(fmt::format("{}{}", word.empty() && text.at_end() ? "the file is cut off: " : "", expected));
    p[k] = *x;
    if (where.line == 0 && !(std::abs(*x) < k_farthest)) where = text.where();
  }
  append_position(soup, p, [&] { return where; });
}

void read_triangles(std::string_view bytes, const std::string& path, Diagnostics& diagnostics, std::vector<Vec3d>& positions,
                    std::vector<Triangle>& triangles) {
  PolygonSoup soup = read_polygons(bytes, path, diagnostics);
  if (soup.face_count() == 0) throw Error(ExitStatus::bad_data, "the mesh has no faces", {path, 0, 0});
  std::vector<uint32_t> corners;
  for (size_t f = 0; f < soup.face_count(); ++f) {
    corners.assign(soup.corners.begin() + static_cast<std::ptrdiff_t>(soup.face_begin(f)),
                   soup.corners.begin() + static_cast<std::ptrdiff_t>(soup.face_ends[f]));
    triangulate(soup.positions, corners, triangles);
    if (triangles.size() > k_most_faces)
      throw Error(ExitStatus::bad_data, fmt::format("more triangles than the limit of {}", k_most_faces), {path, 0, 0});
  }
  positions = std::move(soup.positions);
}

} // namespace kelpie
