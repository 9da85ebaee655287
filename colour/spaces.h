// Colour spaces by name, through OpenColorIO. The working space is whatever the role scene_linear is
// (ACEScg in our own config). Everything here may be called from any thread.
//
// Which config is in force: the file given to use_ocio_config() (`--ocio`), else the one that $OCIO
// names, else ours (colour/config.cpp). A config that cannot be used is an Error, never replaced.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "base/vec.h"

namespace kelpie {

/// Spaces of our own config. They can be converted from under any config that has the role
/// aces_interchange, whatever names it uses itself.
inline constexpr const char* k_space_acescg = "ACEScg";
inline constexpr const char* k_space_aces2065 = "ACES2065-1";
inline constexpr const char* k_space_linear_rec709 = "Linear Rec.709";
inline constexpr const char* k_space_srgb = "sRGB";

/// Uses the OCIO config file at `path` from now on; an empty path: $OCIO, else ours. Reads the config at
/// once, so that a bad one is reported before anything else: throws Error missing_input.
void use_ocio_config(std::string path);

/// What identifies the contents of the config in force: pictures of one scene under two configs differ.
std::string ocio_config_id();

/// `rgb` of the space or role (`color_picking`, `texture_paint`, `data`, "sRGB"…) as scene-linear.
/// Throws Error bad_data for a name that is unknown, listing those that are known.
Vec3 to_scene_linear(const Vec3& rgb, const std::string& space_or_role);

/// Many pixels in place: interleaved, `channels` 3 or 4 a pixel; a fourth channel is left as it is.
/// Uses all threads; the result does not depend on how many there are.
void to_scene_linear(float* pixels, size_t pixel_count, int channels, const std::string& space_or_role);

/// CIE xy of red, green, blue and white, in this order: rx ry gx gy bx by wx wy.
using Chromaticities = std::array<float, 8>;

/// Linear pixels of any primaries (an EXR file's attribute `chromaticities`) to scene-linear, in place.
/// Whites are adapted by the Bradford transform. Throws Error bad_data where the primaries span no gamut.
void to_scene_linear(float* pixels, size_t pixel_count, int channels, const Chromaticities&);

/// The primaries of the working space, for file headers. None when they are not known: the config in
/// force has no role aces_interchange, or scene_linear is neither ACEScg, ACES2065-1 nor linear Rec.709.
std::optional<Chromaticities> scene_linear_chromaticities();

/// Every name that to_scene_linear() understands under the config in force: spaces, then roles.
std::vector<std::string> colour_space_names();

} // namespace kelpie
