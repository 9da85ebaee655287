#include "field/clouds/cloud_file.h"

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>

#include <fmt/format.h>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/file_bytes.h"
#include "field/files/ply.h"

namespace kelpie {

namespace {

constexpr std::array k_properties{"x", "y", "z", "radius", "weight"};

/// As for everything that scenes name.
constexpr size_t k_most_blobs = 10'000'000;

void append_little_endian(std::string& bytes, float value) {
  const uint32_t bits = std::bit_cast<uint32_t>(value);
  for (int shift = 0; shift < 32; shift += 8) bytes += static_cast<char>(bits >> shift & 0xff);
}

Blob to_blob(const std::array<double, 5>& v, size_t index, const SourcePosition& where) {
  for (size_t k = 0; k < v.size(); ++k)
    if (!std::isfinite(static_cast<float>(v[k])))
      throw Error(ExitStatus::bad_data, fmt::format("blob {}: {} is not a finite number", index, k_properties[k]), where);
  Blob b;
  b.centre = Vec3(v[0], v[1], v[2]);
  b.radius = static_cast<float>(v[3]);
  b.weight = static_cast<float>(v[4]);
  if (!(b.radius > 0)) throw Error(ExitStatus::bad_data, fmt::format("blob {}: the radius must be above 0, not {}", index, v[3]), where);
  return b;
}

} // namespace

BlobCloud read_blob_cloud(const std::string& path) { return parse_blob_cloud(read_file_bytes(path), path); }

BlobCloud parse_blob_cloud(const std::string& bytes, const std::string& path) {
  const PlyHeader header = read_ply_header(bytes, path);
  std::array<int, 5> column{};
  const PlyElement* vertices = nullptr;
  for (const PlyElement& e : header.elements)
    if (e.name == "vertex") vertices = &e;
  if (!vertices || vertices->count == 0) throw Error(ExitStatus::bad_data, "the cloud has no blobs (no vertices)", {path, 0, 0});
  if (vertices->count > k_most_blobs)
    throw Error(ExitStatus::bad_data, fmt::format("{} blobs are more than the limit of {}", vertices->count, k_most_blobs),
                {path, vertices->line, 0});
  for (size_t k = 0; k < column.size(); ++k) {
    column[k] = vertices->column(k_properties[k]);
    if (column[k] < 0)
      throw Error(ExitStatus::bad_data,
                  fmt::format("the vertices have no property \"{}\"; a cloud needs x y z radius weight", k_properties[k]),
                  {path, vertices->line, 0});
  }
  BlobCloud cloud;
  cloud.reserve(vertices->count);
  read_ply_rows(bytes, path, header, [&](const PlyElement& e, const PlyRow& row) {
    if (&e != vertices) return;
    std::array<double, 5> v{};
    for (size_t k = 0; k < v.size(); ++k) v[k] = row.scalars[column[k]];
    cloud.push_back(to_blob(v, cloud.size(), {path, row.line, 0}));
  });
  return cloud;
}

std::string blob_cloud_bytes(const BlobCloud& cloud) {
  std::string bytes =
      fmt::format("ply\nformat binary_little_endian 1.0\ncomment kelpie {}: blobs, radius of influence\nelement vertex {}\n",
                  KELPIE_VERSION, cloud.size());
  for (const char* name : k_properties) bytes += fmt::format("property float {}\n", name);
  bytes += "end_header\n";
  for (const Blob& b : cloud)
    for (const float value : {b.centre.x, b.centre.y, b.centre.z, b.radius, b.weight}) append_little_endian(bytes, value);
  return bytes;
}

void write_blob_cloud(const std::string& path, const BlobCloud& cloud) { write_file_atomically(path, as_bytes(blob_cloud_bytes(cloud))); }

} // namespace kelpie
