// The scene of `kelpie liquid`: a mesh on a floor melts, flows and sets as another, and that as the next, followed by a camera.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "base/atomic_file.h"
#include "cli/liquid_end.h"
#include "cli/shot.h"

namespace kelpie {

struct LiquidSceneOptions {
  int first = 1, last = 96;
  std::string surface = "metal"; ///< a kind of material or a preset
  double aspect = 16.0 / 9;      ///< width over height of the picture
  CameraMove camera = CameraMove::orbit;
  bool ends_are_meshes = true; ///< else they are the blobs that were fitted
  bool is_loop = false;        ///< the last mesh becomes the first: the frame after `last` would be `first`

  size_t passages(size_t ends) const { return is_loop ? ends : ends - 1; }
  /// Of all passages together. Each has the same share.
  int length() const { return last - first + (is_loop ? 1 : 0); }
};

/// The files of a scene called `path`: beside it, unless the ends are fits, copies of the meshes (NAME_from_mesh, NAME_to_mesh, with the
/// endings of their files), then the clouds, NAME_from.ply and NAME_to.ply, and last the scene itself. Where there are more than two ends,
/// or in a loop, they are called NAME_1, NAME_2 and so on. Throws Error, bad_data, where a cloud has no surface, and missing_input where a
/// mesh cannot be read.
std::vector<FileToWrite> liquid_scene_files(const std::string& path, std::span<const LiquidEnd> ends, const LiquidSceneOptions&);

} // namespace kelpie
