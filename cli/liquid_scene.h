// The scene of `kelpie liquid`: two clouds on a floor, seen by a camera that holds the whole morph.
#pragma once

#include <string>
#include <vector>

#include "base/atomic_file.h"
#include "field/potential/blob.h"

namespace kelpie {

struct LiquidSceneOptions {
  int first = 1, last = 96;
  std::string surface = "metal"; ///< a kind of material or a preset
  double aspect = 16.0 / 9;      ///< width over height of the picture
};

/// The directions that may be up in a mesh.
inline constexpr const char* k_up_axes[] = {"+x", "-x", "+y", "-y", "+z", "-z"};

/// The cloud turned so that `up` (one of k_up_axes) becomes +y.
BlobCloud turned_upright(BlobCloud, const std::string& up);

/// Brings both clouds to one volume (as far as their sizes stay within a factor of 1.5), the larger one 3 units
/// across, centred above the origin, standing on y = 0. Throws Error, bad_data, where a cloud has no surface.
void place_together(BlobCloud& from, BlobCloud& to);

/// The files of a scene called `path`: beside it the clouds, NAME_from.ply and NAME_to.ply, and last the scene itself.
std::vector<FileToWrite> liquid_scene_files(const std::string& path, const BlobCloud& from, const BlobCloud& to, const LiquidSceneOptions&);

} // namespace kelpie
