#include "cli/liquid_scene.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include <fmt/format.h>

#include "base/file_bytes.h"
#include "field/clouds/cloud_file.h"
#include "morph/liquid/interpolate.h"
#include "morph/liquid/volume.h"
#include "scene/parameter_types.h"

namespace kelpie {

namespace {

/// The share of the frames for which either end is held, that of the way in which it melts, and that of the hold in which it has begun to.
constexpr double k_hold = 0.08, k_melt = 0.16, k_early = 0.5;

/// The lattice of a mesh: voxels along its longest side; and what is smooth in it.
constexpr double k_voxels = 192;
constexpr int k_crease_degrees = 40;

/// Points of a mesh that the camera holds in view.
constexpr size_t k_seen_vertices = 3000;

/// A number that goes from one value to another, smoothly, between two frames.
std::string eased(double first, double last, int from, int to) {
  return fmt::format(R"({{ "keys": [[{:.6g}, {}, 0], [{:.6g}, {}, 0]], "interpolation": "hermite" }})", first, from, last, to);
}

/// When either end is left and reached, and when it melts and sets: frames.
struct Passage {
  double leaves, arrives, melts, molten, sets, set;

  explicit Passage(const LiquidSceneOptions& o) {
    const double hold = std::round(k_hold * (o.last - o.first));
    leaves = o.first + hold, arrives = std::max(o.last - hold, leaves + 1);
    const double melting = k_melt * (arrives - leaves);
    melts = leaves - k_early * hold, molten = leaves + melting;
    set = arrives + k_early * hold, sets = arrives - melting;
  }
  double progress(double frame) const {
    const double t = std::clamp((frame - leaves) / (arrives - leaves), 0.0, 1.0);
    return t * t * (3 - 2 * t);
  }
};

void see(const LiquidEnd& end, SubjectMoment& moment) {
  const size_t step = 1 + end.mesh.positions.size() / k_seen_vertices;
  const Affine place = end.placement.map();
  for (size_t i = 0; i < end.mesh.positions.size(); i += step)
    moment.points.push_back(Vec3(place(end.mesh.origin + end.mesh.positions[i])));
}

/// What the camera follows.
std::vector<SubjectMoment> moments_of(const LiquidEnd& from, const LiquidEnd& to, const LiquidSceneOptions& o) {
  constexpr int k_intervals = 32;
  const LiquidMorph morph(from.placement.placed(from.fit), to.placement.placed(to.fit), Correspondence::flow, VolumeRule::linear,
                          o.ends_are_meshes ? LiquidEnds::molten : LiquidEnds::exact);
  const Passage passage(o);
  std::vector<SubjectMoment> moments;
  for (int i = 0; i <= k_intervals; ++i) {
    const double frame = o.first + (o.last - o.first) * double(i) / k_intervals;
    BlobCloud cloud;
    morph.append_blobs(static_cast<float>(passage.progress(frame)), cloud);
    moments.push_back({frame, points_inside(cloud)});
    if (frame < passage.molten) see(from, moments.back());
    if (frame > passage.sets) see(to, moments.back());
  }
  return moments;
}

bool is_pattern(std::string_view name) {
  const std::vector<std::string_view> patterns = kind_names<PatternKinds>();
  return std::find(patterns.begin(), patterns.end(), name) != patterns.end();
}

/// The mesh itself, in its place, as long as it is one.
std::string mesh_text(const LiquidEnd& end, const std::string& file, const std::string& weight) {
  const Vec3d extent = bounding_box(end.mesh).extent();
  const double voxel = std::max({extent.x, extent.y, extent.z}) / k_voxels;
  const std::string weld = end.weld > 0 ? fmt::format(", \"weld\": {:.9g}", end.weld) : "";
  return end.placement.placed_text(fmt::format(R"({{ "kind": "sdf_mesh", "file": "{}", "voxel": {:.4g}, "crease": {}{}, "weight": {} }})",
                                               file, voxel, k_crease_degrees, weld, weight));
}

/// `more`: further parameters, each after a comma.
std::string liquid_text(const std::string& stem, const Passage& p, const std::string& more) {
  return fmt::format(R"({{ "kind": "liquid", "from": "{}_from.ply", "to": "{}_to.ply", "volume": "linear",
            "progress": {}{} }})",
                     stem, stem, eased(p.leaves, p.arrives, 0, 1), more);
}

/// Melt, flow, set: the weights of the mesh and of the liquid sum to 1, so at either end the field is the mesh's alone.
std::string melting_text(const std::string& liquid, const std::string& first, const std::string& last, const std::string& material) {
  return fmt::format(R"({{ "kind": "blend"{}, "children": [
          {},
          {},
          {} ] }})",
                     material, first, liquid, last);
}

/// What the copy of a mesh beside the scene is called.
std::string copied_name(const std::string& stem, const char* which, const LiquidEnd& end) {
  return fmt::format("{}_{}_mesh{}", stem, which, std::filesystem::path(end.path).extension().string());
}

} // namespace

std::vector<FileToWrite> liquid_scene_files(const std::string& path, const LiquidEnd& from, const LiquidEnd& to,
                                            const LiquidSceneOptions& o) {
  namespace fs = std::filesystem;
  const fs::path folder = fs::path(path).parent_path();
  const std::string stem = fs::path(path).stem().string();
  const CameraPath camera = follow(moments_of(from, to, o), o.camera, o.aspect);
  // A pattern is the liquid's own, so that it flows with it.
  const bool flows = is_pattern(o.surface);
  const std::string material = flows ? fmt::format(", \"material\": \"{}\"", o.surface) : "";
  const std::string look = flows                  ? ""
                           : o.surface == "metal" ? ",\n      \"surface\": { \"kind\": \"metal\", \"roughness\": 0.15 }"
                                                  : fmt::format(",\n      \"surface\": \"{}\"", o.surface);
  std::vector<FileToWrite> files;
  const Passage passage(o);
  std::string field;
  if (o.ends_are_meshes) {
    const std::string first = copied_name(stem, "from", from), last = copied_name(stem, "to", to);
    files.push_back({folder / first, read_file_bytes(from.path)}), files.push_back({folder / last, read_file_bytes(to.path)});
    const std::string weight =
        fmt::format(R"({{ "keys": [[{:.6g}, 0, 0], [{:.6g}, 1, 0], [{:.6g}, 1, 0], [{:.6g}, 0, 0]], "interpolation": "hermite" }})",
                    passage.melts, passage.molten, passage.sets, passage.set);
    const std::string liquid =
        liquid_text(stem, passage, fmt::format(",\n            \"ends\": \"molten\", \"weight\": {}{}", weight, material));
    field = melting_text(liquid, mesh_text(from, first, eased(passage.melts, passage.molten, 1, 0)),
                         mesh_text(to, last, eased(passage.sets, passage.set, 0, 1)), material);
  } else {
    field = liquid_text(stem, passage, material);
  }
  const std::string text = fmt::format(
      R"(// Made by kelpie liquid. `kelpie kinds liquid` explains the words.
{{
  "kelpie": 1,
  "frames": {{ "first": {first}, "last": {last}, "fps": 24 }},
  "camera": {camera},
  "film": {{ "resolution": [1280, 720], "spp": 64, "bounces": 4 }},
  "lights": {lights},
  "shapes": [
    {{
      "name": "liquid",
      "threshold": 1,
      "field": {field}{look}
    }},
    {floor}
  ]
}}
)",
      fmt::arg("first", o.first), fmt::arg("last", o.last), fmt::arg("camera", camera.text()), fmt::arg("lights", shot_lights_text()),
      fmt::arg("floor", shot_floor_text()), fmt::arg("field", field), fmt::arg("look", look));
  files.push_back({folder / (stem + "_from.ply"), blob_cloud_bytes(from.placement.placed(from.fit))});
  files.push_back({folder / (stem + "_to.ply"), blob_cloud_bytes(to.placement.placed(to.fit))});
  files.push_back({path, text});
  return files;
}

} // namespace kelpie
