// What a scene's text may lead to: a scene that can be sampled, or an Error.
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "field/clouds/cloud_file.h"
#include "scene/reader.h"

namespace kelpie {
namespace {

namespace fs = std::filesystem;

/// A folder with the files that scenes may name, for as long as the program runs.
class Folder {
public:
  Folder() {
    std::string pattern = (fs::temp_directory_path() / "kelpie-fuzz-XXXXXX").string();
    if (!mkdtemp(pattern.data())) std::abort();
    path_ = pattern;
    write_blob_cloud((path_ / "cloud.ply").string(), {{{0, 1, 0}, 2, 1.5f}});
    std::ofstream(path_ / "mesh.obj") << "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
  }
  ~Folder() { fs::remove_all(path_); }
  std::string scene() const { return (path_ / "scene.json").string(); }

private:
  fs::path path_;
};

bool contains(std::string_view text, std::string_view part) { return text.find(part) != text.npos; }

} // namespace
} // namespace kelpie

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  static const kelpie::Folder folder;
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  // Lattices, refined meshes and tables take seconds, and are tested elsewhere.
  for (const std::string_view slow : {"sdf_mesh", "subdivision", "\\u"})
    if (kelpie::contains(text, slow)) return 0;
  std::ofstream(folder.scene(), std::ios::binary) << text;
  try {
    kelpie::Diagnostics diagnostics;
    const kelpie::Scene scene = kelpie::read_scene(folder.scene(), {{}, {}, false}, diagnostics);
    for (const double frame : {1.0, 7.25}) kelpie::sample(scene, frame).exposure();
  } catch (const kelpie::Error& e) {
    if (e.status != kelpie::ExitStatus::bad_data && e.status != kelpie::ExitStatus::missing_input) std::abort();
  }
  return 0;
}
