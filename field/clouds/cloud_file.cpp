#include "field/clouds/cloud_file.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <optional>

#include <fmt/format.h>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/file_bytes.h"
#include "field/files/ply.h"

namespace kelpie {

namespace {

constexpr std::array k_properties{"x", "y", "z", "radius", "weight"};
/// Rows of a matrix that takes p - centre into the unit ball, of ellipsoids. The radius counts for nothing then.
constexpr std::array k_shape_properties{"ax", "ay", "az", "bx", "by", "bz", "cx", "cy", "cz"};

/// As for everything that scenes name.
constexpr size_t k_most_blobs = 10'000'000;

void append_little_endian(std::string& bytes, float value) {
  const uint32_t bits = std::bit_cast<uint32_t>(value);
  for (int shift = 0; shift < 32; shift += 8) bytes += static_cast<char>(bits >> shift & 0xff);
}

/// Where the numbers of a blob stand among its vertex's.
struct Columns {
  std::array<int, k_properties.size()> always{};
  std::optional<std::array<int, k_shape_properties.size()>> shape; ///< of a cloud of ellipsoids
};

Columns columns_of(const PlyElement& vertices, const std::string& path) {
  Columns columns;
  const SourcePosition where{path, vertices.line, 0};
  for (size_t k = 0; k < k_properties.size(); ++k) {
    columns.always[k] = vertices.column(k_properties[k]);
    if (columns.always[k] < 0)
      throw Error(ExitStatus::bad_data,
                  fmt::format("the vertices have no property \"{}\"; a cloud needs x y z radius weight", k_properties[k]), where);
  }
  const auto is_there = [&](const char* name) { return vertices.column(name) >= 0; };
  if (std::none_of(k_shape_properties.begin(), k_shape_properties.end(), is_there)) return columns;
  columns.shape.emplace();
  for (size_t k = 0; k < k_shape_properties.size(); ++k) {
    (*columns.shape)[k] = vertices.column(k_shape_properties[k]);
    if ((*columns.shape)[k] < 0)
      throw Error(ExitStatus::bad_data,
                  fmt::format("the vertices have no property \"{}\"; a cloud of ellipsoids needs ax ay az bx by bz cx cy cz",
                              k_shape_properties[k]),
                  where);
  }
  return columns;
}

Blob to_blob(const PlyRow& row, const Columns& columns, size_t index, const std::string& path) {
  const SourcePosition where{path, row.line, 0};
  const auto number = [&](int column, const char* name) {
    const double v = row.scalars[static_cast<size_t>(column)];
    if (!std::isfinite(static_cast<float>(v)))
      throw Error(ExitStatus::bad_data, fmt::format("blob {}: {} is not a finite number", index, name), where);
    return v;
  };
  std::array<double, k_properties.size()> v{};
  for (size_t k = 0; k < v.size(); ++k) v[k] = number(columns.always[k], k_properties[k]);
  Blob b;
  b.centre = Vec3(v[0], v[1], v[2]);
  b.radius = static_cast<float>(v[3]);
  b.weight = static_cast<float>(v[4]);
  if (!columns.shape) {
    if (!(b.radius > 0)) throw Error(ExitStatus::bad_data, fmt::format("blob {}: the radius must be above 0, not {}", index, v[3]), where);
    return b;
  }
  Mat3d rows; // glm's matrices are made of columns
  for (size_t k = 0; k < k_shape_properties.size(); ++k)
    rows[static_cast<int>(k) % 3][static_cast<int>(k) / 3] = number((*columns.shape)[k], k_shape_properties[k]);
  if (!set_ellipsoid(b, rows))
    throw Error(
        ExitStatus::bad_data,
        fmt::format("blob {}: ax … cz make no ellipsoid whose axes are within a factor of {:.0f} of each other", index, k_longest_blob),
        where);
  return b;
}

} // namespace

BlobCloud read_blob_cloud(const std::string& path) { return parse_blob_cloud(read_file_bytes(path), path); }

BlobCloud parse_blob_cloud(const std::string& bytes, const std::string& path) {
  const PlyHeader header = read_ply_header(bytes, path);
  const PlyElement* vertices = nullptr;
  for (const PlyElement& e : header.elements)
    if (e.name == "vertex") vertices = &e;
  if (!vertices || vertices->count == 0) throw Error(ExitStatus::bad_data, "the cloud has no blobs (no vertices)", {path, 0, 0});
  if (vertices->count > k_most_blobs)
    throw Error(ExitStatus::bad_data, fmt::format("{} blobs are more than the limit of {}", vertices->count, k_most_blobs),
                {path, vertices->line, 0});
  const Columns columns = columns_of(*vertices, path);
  BlobCloud cloud;
  cloud.reserve(vertices->count);
  read_ply_rows(bytes, path, header, [&](const PlyElement& e, const PlyRow& row) {
    if (&e != vertices) return;
    cloud.push_back(to_blob(row, columns, cloud.size(), path));
  });
  return cloud;
}

std::string blob_cloud_bytes(const BlobCloud& cloud) {
  std::string bytes =
      fmt::format("ply\nformat binary_little_endian 1.0\ncomment kelpie {}: blobs, radius of influence\nelement vertex {}\n",
                  KELPIE_VERSION, cloud.size());
  const bool is_round = std::all_of(cloud.begin(), cloud.end(), kelpie::is_round);
  for (const char* name : k_properties) bytes += fmt::format("property float {}\n", name);
  if (!is_round)
    for (const char* name : k_shape_properties) bytes += fmt::format("property float {}\n", name);
  bytes += "end_header\n";
  for (const Blob& b : cloud) {
    for (const float value : {b.centre.x, b.centre.y, b.centre.z, b.radius, b.weight}) append_little_endian(bytes, value);
    if (is_round) continue;
    const SymmetricMat3 m = to_unit_ball(b);
    for (const float value : {m.xx, m.xy, m.xz, m.xy, m.yy, m.yz, m.xz, m.yz, m.zz}) append_little_endian(bytes, value);
  }
  return bytes;
}

void write_blob_cloud(const std::string& path, const BlobCloud& cloud) { write_file_atomically(path, as_bytes(blob_cloud_bytes(cloud))); }

} // namespace kelpie
