#include "cli/mesh_source.h"

#include <algorithm>
#include <array>
#include <filesystem>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/atomic_file.h"
#include "base/standard_streams.h"
#include "base/suggest.h"
#include "cli/command.h"
#include "cli/failure.h"
#include "renderer/mesh/mesh_frame.h"
#include "renderer/output/mesh_file.h"

namespace kelpie {

namespace {

constexpr std::string_view k_scene_ending = ".json";

/// Meshes are written in millimetres: with this one is a unit of the scene.
constexpr double k_scene_units = 1e-3;

struct ShapeOfScene {
  std::string scene, shape; ///< the shape may be left out
};

/// Nothing for the path of a mesh.
std::optional<ShapeOfScene> shape_of_scene(const std::string& text) {
  if (std::filesystem::exists(text) && !text.ends_with(k_scene_ending)) return {};
  if (text.ends_with(k_scene_ending)) return ShapeOfScene{text, {}};
  const size_t at = text.rfind(std::string(k_scene_ending) + ":");
  if (at == std::string::npos) return {};
  const size_t colon = at + k_scene_ending.size();
  return ShapeOfScene{text.substr(0, colon), text.substr(colon + 1)};
}

size_t find_shape(const Scene& scene, const ShapeOfScene& wanted) {
  std::vector<std::string_view> all, fields;
  for (const Shape& s : scene.shapes) {
    all.push_back(s.name);
    if (s.field) fields.push_back(s.name);
  }
  if (fields.empty()) throw Error(ExitStatus::bad_data, "no shape has a field that could be meshed", {wanted.scene});
  const auto place_of = [&](std::string_view name) { return size_t(std::find(all.begin(), all.end(), name) - all.begin()); };
  if (wanted.shape.empty()) {
    if (fields.size() == 1) return place_of(fields[0]);
    throw Error(ExitStatus::usage, fmt::format("which shape of {0}? {0}:SHAPE, one of {1}", wanted.scene, fmt::join(fields, ", ")));
  }
  const size_t i = place_of(wanted.shape);
  if (i == all.size())
    throw Error(ExitStatus::usage,
                fmt::format("{}: no shape is called \"{}\"{}", wanted.scene, wanted.shape, suggestion(wanted.shape, fields)));
  if (!scene.shapes[i].field)
    throw Error(ExitStatus::usage, fmt::format("{}: \"{}\" is ordinary geometry: of all shapes only {} {} a field", wanted.scene,
                                               wanted.shape, fmt::join(fields, ", "), fields.size() == 1 ? "has" : "have"));
  return i;
}

/// What any file system takes.
std::string file_name_of(std::string name) {
  const auto is_plain = [](char c) { return (c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || c == '-'; };
  for (char& c : name)
    if (!is_plain(c)) c = '_';
  return name.substr(0, 60);
}

} // namespace

MeshSources::MeshSources(const ReadOptions& options) { options_.allow_paths = options.allow_paths, options_.use_cache = options.use_cache; }

MeshSource MeshSources::resolve(const std::string& text) {
  const std::optional<ShapeOfScene> wanted = shape_of_scene(text);
  if (!wanted) return {text, std::filesystem::path(text).stem().string(), text};
  set_activity(fmt::format("meshing {}", text));
  Diagnostics diagnostics;
  const Scene scene = read_scene(wanted->scene, options_, diagnostics);
  print_warnings(diagnostics);
  const std::array<size_t, 1> shape{find_shape(scene, *wanted)};
  const std::string& name = scene.shapes[shape[0]].name;
  MeshFrameOptions how;
  how.units = k_scene_units;
  const MeshedFrame meshed = mesh_frame(sample(scene, scene.frames.first), shape, how);
  const size_t triangles = meshed.objects[0].mesh.triangles.size();
  if (triangles == 0)
    throw Error(ExitStatus::bad_data, fmt::format("\"{}\" has no surface in frame {}", name, scene.frames.first), {wanted->scene});
  print_message(fmt::format("{}:{}: meshed with {} triangles, as in frame {}\n", wanted->scene, name, triangles, scene.frames.first));
  if (!folder_) folder_ = std::make_unique<TemporaryFolder>();
  const std::string file = folder_->file(fmt::format("{}_{}.ply", ++meshed_, file_name_of(name)));
  write_files_atomically({{file, mesh_file_bytes(MeshFormat::ply, meshed.objects)}});
  return {file, file_name_of(name), fmt::format("{}:{}", wanted->scene, name)};
}

} // namespace kelpie
