// The readers of mesh files. `bytes` is the whole file, `file` its name in messages; all throw Error,
// bad_data, at the first fault.
#pragma once

#include <string>
#include <string_view>

#include "field/mesh/mesh.h"

namespace kelpie {

PolygonSoup read_obj(std::string_view bytes, const std::string& file, Diagnostics&);
PolygonSoup read_off(std::string_view bytes, const std::string& file);
PolygonSoup read_ply_mesh(std::string_view bytes, const std::string& file);
PolygonSoup read_stl(std::string_view bytes, const std::string& file);

/// Whether the size is exactly that which the count of a binary STL file calls for. (Binary files may
/// begin with "solid" as well.)
bool is_binary_stl(std::string_view bytes);

/// Reads a file of any of the formats, told apart by content where it is plain, else by name.
PolygonSoup read_polygons(std::string_view bytes, const std::string& file, Diagnostics&);

/// The same, and cuts its faces into triangles. Throws
/// Error, bad_data, also where there is no face or there are too many.
void read_triangles(std::string_view bytes, const std::string& file, Diagnostics&, std::vector<Vec3d>& positions,
                    std::vector<Triangle>& triangles);

/// Appends a face of the given corners.
void append_face(PolygonSoup&, const std::vector<uint32_t>& corners, int line, const std::string& file);

} // namespace kelpie
