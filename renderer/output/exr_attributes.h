// What both the writer and the reader of frames must know of OpenEXR.
#pragma once

#include <OpenEXR/ImfFrameBuffer.h>

#include "renderer/output/packed_pixels.h"

namespace kelpie {

// Attributes of headers.
inline constexpr const char* k_frame_attribute = "kelpie:frame";
inline constexpr const char* k_scene_hash_attribute = "kelpie:sceneHash";
inline constexpr const char* k_pixel_hash_attribute = "kelpie:pixelHash";
inline constexpr const char* k_meta_attribute = "kelpie:meta";
inline constexpr const char* k_camera_attribute = "worldToCamera";
inline constexpr const char* k_ndc_attribute = "worldToNDC";

/// Where OpenEXR finds or puts the pixels.
inline Imf::FrameBuffer frame_buffer_on(PackedPixels& packed, const FrameImage& image, const Imath::Box2i& window) {
  Imf::FrameBuffer buffer;
  for (const size_t c : packed.order) {
    const FrameChannel& channel = image.channels[c];
    const size_t size = size_of(channel.depth);
    buffer.insert(channel.name, Imf::Slice::Make(channel.depth == ChannelDepth::half ? Imf::HALF : Imf::FLOAT,
                                                 packed.bytes.data() + packed.offsets[c], window, size, packed.row_size));
  }
  return buffer;
}

} // namespace kelpie
