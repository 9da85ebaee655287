// The files that a scene names: which of them it may read, and what is in them.
#pragma once

#include <filesystem>
#include <map>

#include "scene/scene.h"

namespace kelpie {

/// The folder tree that a scene may read from, so that a scene from elsewhere cannot read what is none
/// of its business.
class AssetFolder {
public:
  /// Paths are relative to the folder of `scene_path`; what lies under one of `allow_paths` is free too.
  AssetFolder(const std::string& scene_path, const std::vector<std::string>& allow_paths);

  /// The canonical path of a file that exists (symbolic links resolved), as written in a file whose own folder is `from`
  /// within the scene's. Throws Error bad_data for one outside (unless `is_free`: it was named on the command line),
  /// missing_input where it is missing.
  std::string resolve(const std::filesystem::path& from, const std::string& as_written, bool is_free) const;

  /// The canonical path of the scene itself.
  std::string scene_file() const { return scene_.string(); }

private:
  std::filesystem::path scene_, folder_;
  std::vector<std::filesystem::path> allowed_;
};

/// The assets of a scene: as written, relative to it, and where they are.
using AssetFiles = std::map<std::string, std::string>;

/// XXH3 (128 bits, hexadecimal) of a document's canonical text and the bytes of its assets.
std::string hash_scene(const std::string& canonical_text, const AssetFiles&);

} // namespace kelpie
