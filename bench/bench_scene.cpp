#include "bench/bench_scene.h"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>

#include <fmt/format.h>
#include <unistd.h>

#include "bench/creature_tree.h"
#include "bench/knot_cloud.h"
#include "scene/reader.h"

namespace kelpie {

namespace {

FrameScene cloud_scene(int count) {
  Blobs<SampledMode> blobs;
  blobs.cloud = std::make_shared<const BlobCloud>(make_knot_cloud(count));
  SampledShape shape;
  shape.name = "knot", shape.field.nodes.emplace_back(blobs);
  FrameScene scene;
  scene.shapes.push_back(std::move(shape));
  scene.camera.position = Vec3(0.6f, 2.2f, 5.2f), scene.camera.look_at = Vec3(0);
  return scene;
}

FrameScene file_scene(const std::string& path) {
  Diagnostics diagnostics;
  const Scene scene = read_scene(path, {}, diagnostics);
  return sample(scene, scene.frames.first);
}

FrameScene creature_scene(CreatureWarps warps) {
  const auto path = std::filesystem::temp_directory_path() / fmt::format("kelpie-creature.{}.json", getpid());
  std::ofstream(path) << make_creature_scene(warps);
  FrameScene scene = file_scene(path);
  std::filesystem::remove(path);
  return scene;
}

} // namespace

FrameScene bench_scene(const std::string& name) {
  for (const CreatureWarps warps : {CreatureWarps::none, CreatureWarps::twist, CreatureWarps::bend})
    if (name == creature_name(warps)) return creature_scene(warps);
  const bool is_number = std::all_of(name.begin(), name.end(), [](unsigned char c) { return std::isdigit(c); });
  return is_number ? cloud_scene(std::stoi(name)) : file_scene(name);
}

} // namespace kelpie
