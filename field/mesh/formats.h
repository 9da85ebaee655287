// The readers of mesh files. `bytes` is the whole file, `file` its name in messages; all throw Error,
// bad_data, at the first fault.
#pragma once

#include <cmath>
#include <string>
#include <string_view>

#include "field/files/text_cursor.h"
#include "field/mesh/mesh.h"

namespace kelpie {

/// Beyond this a coordinate is no place: its cube must be far from overflow.
constexpr double k_farthest = 1e30;

inline bool is_usable(const Vec3d& p) { return std::abs(p.x) < k_farthest && std::abs(p.y) < k_farthest && std::abs(p.z) < k_farthest; }

PolygonSoup read_obj(std::string_view bytes, const std::string& file, Diagnostics&);
PolygonSoup read_off(std::string_view bytes, const std::string& file);
PolygonSoup read_ply_mesh(std::string_view bytes, const std::string& file);
PolygonSoup read_stl(std::string_view bytes, const std::string& file);

// How they are told apart:

/// Whether the first word of the text is `ply`.
bool is_ply(std::string_view bytes);
/// Whether a file that begins with this word is an OFF file: OFF, COFF, OFF642, …
bool is_off_header(std::string_view word);
/// Whether it is a binary STL file by its size, or text that begins with `solid` and has facets.
bool is_stl(std::string_view bytes);

/// Reads a file of any of the formats, told apart by content where it is plain, else by name. Positions that no face uses may have been
/// moved; all are finite. Throws Error, bad_data, where a face uses one that is not, or that is beyond 1e30.
PolygonSoup read_polygons(std::string_view bytes, const std::string& file, Diagnostics&);

/// The same, and cuts its faces into triangles. Throws
/// Error, bad_data, also where there is no face or there are too many.
void read_triangles(std::string_view bytes, const std::string& file, Diagnostics&, std::vector<Vec3d>& positions,
                    std::vector<Triangle>& triangles);

// What the readers share:

/// Appends a face of the given corners.
void append_face(PolygonSoup&, const std::vector<uint32_t>& corners, int line, const std::string& file);

/// Appends a position; `where` yields its SourcePosition, which is noted if it is unusable.
template <class Where>
void append_position(PolygonSoup& soup, const Vec3d& p, Where&& where) {
  if (!is_usable(p)) soup.unusable.emplace_back(static_cast<uint32_t>(soup.positions.size()), where());
  soup.positions.push_back(p);
}

/// Reads three coordinates, words that `next` yields, and appends them. Fails with "expected …" where one is missing or no number.
void read_position(TextCursor&, std::string_view (TextCursor::*next)(), std::string_view expected, PolygonSoup&);

} // namespace kelpie
