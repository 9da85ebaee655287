// What the command line may change about the film: resolution, crop, samples.
#pragma once

#include "cli/render.h"
#include "renderer/film/frame_image.h"
#include "scene/scene.h"

namespace kelpie {

/// Adds --res, --spp, --crop, --quality, --heatmap, --set, --recipe, --recipes, --allow-path, --no-cache, --max-memory and --ocio.
void add_film_options(CLI::App& command, RenderOptions& options);

/// Applies --res, --spp, --quality and --heatmap to the film; returns the window that --crop leaves of it.
/// Throws Error usage.
PixelBox apply_film_options(const RenderOptions& options, Film<AnimatedMode>& film);

/// What a frame's header records: the scene, kelpie's version, the OCIO config, and everything of the command
/// line that pixels depend on. --skip-existing keeps a frame only where all of it is the same.
std::string picture_hash(const Scene& scene, const PixelBox& window);

} // namespace kelpie
