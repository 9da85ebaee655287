// Clouds of blobs as PLY files: vertices with the properties x y z radius weight.
#pragma once

#include <string>

#include "field/potential/blob.h"

namespace kelpie {

/// Reads ASCII and binary PLY; further properties and elements are ignored. `radius` is that of
/// influence, in scene units, above 0; weights may have either sign. All falloffs are quartic.
/// Throws Error: missing_input, or bad_data for anything but at least one blob of finite numbers.
BlobCloud read_blob_cloud(const std::string& path);

/// The same from memory; `path` is for messages.
BlobCloud parse_blob_cloud(const std::string& bytes, const std::string& path);

/// Binary little-endian PLY, float32.
std::string blob_cloud_bytes(const BlobCloud&);

/// Writes blob_cloud_bytes(), all or nothing. Throws Error, cannot_write.
void write_blob_cloud(const std::string& path, const BlobCloud&);

} // namespace kelpie
