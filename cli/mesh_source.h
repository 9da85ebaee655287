// A mesh that a command works on: a file, or a shape of a scene that is meshed for it.
#pragma once

#include <memory>
#include <string>

#include "base/temporary_folder.h"
#include "scene/reader.h"

namespace kelpie {

struct MeshSource {
  std::string path;  ///< of a mesh file
  std::string name;  ///< of what it is made of: the file without its ending, or the shape
  std::string label; ///< as it was said, for messages
};

/// Words for the help of an option.
inline constexpr const char* k_mesh_sources = "OBJ, PLY, OFF or STL, or a shape of a scene as SCENE.json:SHAPE";

/// Meshes the shapes that are asked for; their files go with this.
class MeshSources {
public:
  /// Of `options` what files a scene may read, and whether caches count.
  explicit MeshSources(const ReadOptions& options = {});

  /// `text` is the path of a mesh, or SCENE.json:SHAPE: a shape with a field in the scene's first frame, in scene units; where the scene
  /// has only one, SCENE.json will do. Throws Error: usage for a shape that is not there or has no field, bad_data for one that has no
  /// surface, and whatever reading and meshing a scene throws.
  MeshSource resolve(const std::string& text);

private:
  ReadOptions options_;
  std::unique_ptr<TemporaryFolder> folder_; ///< none as long as nothing was meshed
  size_t meshed_ = 0;
};

} // namespace kelpie
