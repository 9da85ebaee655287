// A folder of its own for a test that reads scenes, gone with the test.
#pragma once

#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

#include "scene/reader.h"

namespace kelpie {

class SceneFolder {
public:
  SceneFolder() {
    std::string pattern = (std::filesystem::temp_directory_path() / "kelpie-scene-XXXXXX").string();
    if (!mkdtemp(pattern.data())) throw std::runtime_error("no temporary folder");
    path_ = std::filesystem::canonical(pattern);
    setenv("XDG_CACHE_HOME", path("cache").c_str(), 1); // what is cached goes with it
    write("cloud.ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
                       "property float radius\nproperty float weight\nend_header\n0 1 0 2 1.5\n");
    write("mesh.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  }
  ~SceneFolder() { std::filesystem::remove_all(path_); }
  SceneFolder(const SceneFolder&) = delete;

  std::string path(const std::string& name) const { return (path_ / name).string(); }

  void write(const std::string& name, std::string_view bytes) const {
    std::filesystem::create_directories((path_ / name).parent_path());
    std::ofstream(path_ / name, std::ios::binary) << bytes;
  }

  /// Reads the text as `scene.json` in this folder.
  Scene read(std::string_view text, const ReadOptions& options = {}) const {
    write("scene.json", text);
    Diagnostics diagnostics;
    return read_scene(path("scene.json"), options, diagnostics);
  }

  /// What is wrong with the text: the lines of its Error, without this folder's name. Empty: nothing.
  std::string errors(std::string_view text, const ReadOptions& options = {}) const { return errors_and_status(text, options).first; }
  ExitStatus status(std::string_view text, const ReadOptions& options = {}) const { return errors_and_status(text, options).second; }

private:
  std::pair<std::string, ExitStatus> errors_and_status(std::string_view text, const ReadOptions& options) const {
    try {
      read(text, options);
      return {"", ExitStatus::ok};
    } catch (const Error& e) {
      std::string lines = e.what();
      const std::string folder = path_.string() + "/";
      for (size_t at; (at = lines.find(folder)) != std::string::npos;) lines.erase(at, folder.size());
      return {lines, e.status};
    }
  }

  std::filesystem::path path_;
};

/// A scene whose only shape has this field.
inline std::string scene_with_field(std::string_view field) {
  return "{\"kelpie\":1,\"shapes\":[{\"name\":\"a\",\"field\":" + std::string(field) + "}]}";
}

} // namespace kelpie
