// Attributes of headers, as the writer and the reader of frames call them.
#pragma once

namespace kelpie {

inline constexpr const char* k_frame_attribute = "kelpie:frame";
inline constexpr const char* k_scene_hash_attribute = "kelpie:sceneHash";
inline constexpr const char* k_pixel_hash_attribute = "kelpie:pixelHash";
inline constexpr const char* k_meta_attribute = "kelpie:meta";
inline constexpr const char* k_camera_attribute = "worldToCamera";
inline constexpr const char* k_ndc_attribute = "worldToNDC";

} // namespace kelpie
