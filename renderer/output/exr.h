// Frames as OpenEXR files: single part, scanlines, ZIP, channels half or float as the frame says.
//
// The same frame and header always make the same bytes: the only date in a file is a fixed one. Each
// file carries the hash of its scene, of its own decoded pixels, and of all its bytes, so that anyone can tell
// later whether it is whole and whether it is still the picture of that scene.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <glm/mat4x4.hpp>

#include "renderer/film/frame_image.h"

namespace kelpie {

/// What a file says about its frame besides the pixels.
struct FrameHeader {
  int frame = 1;
  double fps = 24;
  /// Scene::hash: what the frame was rendered from.
  std::string scene_hash;
  /// Scene::meta, as JSON; empty where there is none.
  std::string meta;
  /// For column vectors; renderer/output/camera_matrices.h makes them.
  std::optional<glm::mat4> camera_from_world, ndc_from_world;
};

struct EncodedFrame {
  std::vector<unsigned char> bytes;
  std::string pixel_hash; ///< XXH3-128 of the channels as they are in the file, 32 hex digits
  size_t clamped = 0;     ///< values beyond 65504 in half channels, written as ±65504
  size_t nonfinite = 0;   ///< infinities (written as the largest value) and NaNs (written as 0)
};

/// In memory: OpenEXR truncates what it opens, and can end with status 0 and a broken file on a full disk; so it never sees the file
/// system. Throws Error internal when it fails.
EncodedFrame encode_exr(const FrameImage&, const FrameHeader&);

struct DecodedFrame {
  FrameImage image;
  FrameHeader header;
  /// CIE xy of red, green, blue, white as in the header, if it has them.
  std::optional<std::array<float, 8>> chromaticities;
  std::string pixel_hash;   ///< as computed from the pixels
  std::string claimed_hash; ///< as the header says; empty in files of other programs

  /// Whether the pixels are those that were written.
  bool is_intact() const { return !claimed_hash.empty() && pixel_hash == claimed_hash; }
};

/// Any EXR file's first part. Throws Error: missing_input when there is no such file, bad_data when it cannot be
/// read whole or exceeds the limits (65,536 pixels a side, 1024 channels).
DecodedFrame read_exr(const std::string& path);

/// The same from memory; `name` is for messages.
DecodedFrame decode_exr(std::span<const unsigned char> bytes, const std::string& name);

/// The hash of its pixels alone, as computed from them.
std::string pixel_hash_of_exr(std::span<const unsigned char> bytes, const std::string& name);

/// Encodes, decodes again and compares, and writes atomically. When this returns, the frame is on the
/// disk, whole. Throws Error: cannot_write, or internal when the encoder broke the picture.
EncodedFrame write_exr(const std::string& path, const FrameImage&, const FrameHeader&);

/// For --skip-existing: whether `path` is a frame of the scene with this hash, and every byte of it is as it was written. Anything
/// wrong with the file means no.
bool frame_is_complete(const std::string& path, const std::string& scene_hash);

} // namespace kelpie
