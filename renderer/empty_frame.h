// Why a frame shows nothing, is black, or is coarse.
#pragma once

#include <string>

#include "renderer/film/frame_image.h"
#include "renderer/integrate/lights.h"
#include "renderer/trace/tracer.h"

namespace kelpie {

/// What to say of a frame in which no pixel is covered ("shows nothing: all shapes lie behind the camera") or in which all that is
/// covered is black ("is black: no light reaches what is in view"); nothing of any other. `image` is what was rendered of `frame`.
std::string why_empty(const FrameScene& frame, const Tracer&, const std::vector<Light>&, const FrameImage& image);

/// What to say of a frame whose shapes lie so far from the origin that float places there are coarser than k_coarse_step of them all.
std::string why_coarse(const FrameScene& frame, const Tracer&);

} // namespace kelpie
