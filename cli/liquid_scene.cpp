#include "cli/liquid_scene.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/file_bytes.h"
#include "field/clouds/cloud_file.h"
#include "morph/liquid/interpolate.h"
#include "morph/liquid/volume.h"
#include "scene/parameter_types.h"

namespace kelpie {

namespace {

/// The share of a passage for which either end is held, that of the way in which it melts, and that of the hold in which it has begun to.
constexpr double k_hold = 0.08, k_melt = 0.16, k_early = 0.5;

/// The lattice of a mesh: voxels along its longest side; and what is smooth in it.
constexpr double k_voxels = 192;
constexpr int k_crease_degrees = 40;

/// Keys nearer than this to each other, in frames, are one.
constexpr double k_least_step = 1e-4;

/// Points of a mesh that the camera holds in view.
constexpr size_t k_seen_vertices = 3000;

/// Points of a curve: frames and values, ascending.
using Points = std::vector<std::pair<double, double>>;

/// When an end is left and the next one is reached, and when they melt and set: frames.
struct Passage {
  double leaves, arrives, melts, molten, sets, set;

  Passage(double first, double last) {
    const double hold = std::round(k_hold * (last - first));
    leaves = first + hold, arrives = std::max(last - hold, leaves + 1);
    const double melting = k_melt * (arrives - leaves);
    melts = leaves - k_early * hold, molten = leaves + melting;
    set = arrives + k_early * hold, sets = arrives - melting;
  }
  double progress(double frame) const {
    const double t = std::clamp((frame - leaves) / (arrives - leaves), 0.0, 1.0);
    return t * t * (3 - 2 * t);
  }
};

/// All of the time.
class Timeline {
public:
  Timeline(size_t ends, const LiquidSceneOptions& o) : o_(o) {
    const size_t count = o.passages(ends);
    for (size_t i = 0; i < count; ++i) passages_.emplace_back(boundary(i, count), boundary(i + 1, count));
    // A cycle begins where no shutter is open, if everything is held there: what jumps from the last end to the first is not seen.
    seam_ = o.first - (passages_[0].melts >= o.first + 0.5 ? 0.5 : 0);
  }

  const std::vector<Passage>& passages() const { return passages_; }
  /// The passage that a frame lies in.
  size_t passage_at(double frame) const {
    return std::min(size_t((frame - o_.first) * double(passages_.size()) / o_.length()), passages_.size() - 1);
  }
  /// The passage that leads away from an end, or to it.
  const Passage* away_from(size_t end) const { return end < passages_.size() ? &passages_[end] : nullptr; }
  const Passage* towards(size_t end) const { return end > 0 ? &passages_[end - 1] : o_.is_loop ? &passages_.back() : nullptr; }

  /// A number that rests at each point, and moves smoothly between them; in a loop over again.
  std::string curve(Points points) const {
    if (o_.is_loop) {
      std::sort(points.begin(), points.end());
      const double before = points.front().second, after = points.back().second;
      points.insert(points.begin(), {seam_, before}), points.push_back({seam_ + o_.length(), after});
    }
    std::vector<std::string> keys;
    for (size_t i = 0; i < points.size(); ++i)
      if (i == 0 || points[i].first > points[i - 1].first + k_least_step)
        keys.push_back(fmt::format("[{:.8g}, {:.8g}, 0]", points[i].first, points[i].second));
    return fmt::format(R"({{ "keys": [{}], "interpolation": "hermite"{} }})", fmt::join(keys, ", "),
                       o_.is_loop ? R"(, "before": "cycle", "after": "cycle")" : "");
  }

private:
  double boundary(size_t i, size_t count) const { return o_.first + o_.length() * double(i) / double(count); }

  LiquidSceneOptions o_;
  std::vector<Passage> passages_;
  double seam_;
};

void see(const LiquidEnd& end, SubjectMoment& moment) {
  const size_t step = 1 + end.mesh.positions.size() / k_seen_vertices;
  const Affine place = end.placement.map();
  for (size_t i = 0; i < end.mesh.positions.size(); i += step)
    moment.points.push_back(Vec3(place(end.mesh.origin + end.mesh.positions[i])));
}

/// What the camera follows.
std::vector<SubjectMoment> moments_of(std::span<const LiquidEnd> ends, const Timeline& time, const LiquidSceneOptions& o) {
  constexpr int k_intervals = 32; // of a passage
  std::vector<LiquidMorph> morphs;
  const auto next = [&](size_t i) -> const LiquidEnd& { return ends[(i + 1) % ends.size()]; };
  for (size_t i = 0; i < time.passages().size(); ++i)
    morphs.emplace_back(ends[i].placement.placed(ends[i].fit), next(i).placement.placed(next(i).fit), Correspondence::flow,
                        VolumeRule::linear, o.ends_are_meshes ? LiquidEnds::molten : LiquidEnds::exact);
  const int intervals = k_intervals * int(morphs.size());
  std::vector<SubjectMoment> moments;
  for (int i = 0; i <= intervals; ++i) {
    const double frame = o.first + o.length() * double(i) / intervals;
    const size_t k = time.passage_at(frame);
    const Passage& passage = time.passages()[k];
    BlobCloud cloud;
    morphs[k].append_blobs(static_cast<float>(passage.progress(frame)), cloud);
    moments.push_back({frame, points_inside(cloud)});
    if (frame < passage.molten) see(ends[k], moments.back());
    if (frame > passage.sets) see(next(k), moments.back());
  }
  return moments;
}

bool is_pattern(std::string_view name) {
  const std::vector<std::string_view> patterns = kind_names<PatternKinds>();
  return std::find(patterns.begin(), patterns.end(), name) != patterns.end();
}

/// Writes the scene and what lies beside it.
class SceneWriter {
public:
  SceneWriter(const std::string& path, std::span<const LiquidEnd> ends, const LiquidSceneOptions& o)
      : path_(path), stem_(path_.stem().string()), ends_(ends), o_(o), time_(ends.size(), o) {}

  std::vector<FileToWrite> files() {
    const std::filesystem::path folder = path_.parent_path();
    std::vector<FileToWrite> files;
    if (o_.ends_are_meshes)
      for (size_t i = 0; i < ends_.size(); ++i) files.push_back({folder / mesh_name(i), read_file_bytes(ends_[i].path)});
    for (size_t i = 0; i < ends_.size(); ++i)
      files.push_back({folder / cloud_name(i), blob_cloud_bytes(ends_[i].placement.placed(ends_[i].fit))});
    files.push_back({path_, text()});
    return files;
  }

private:
  /// What the files of an end are called, after the scene's name.
  std::string which(size_t end) const {
    if (ends_.size() == 2 && !o_.is_loop) return end == 0 ? "from" : "to";
    return std::to_string(end % ends_.size() + 1);
  }
  std::string cloud_name(size_t end) const { return fmt::format("{}_{}.ply", stem_, which(end)); }
  std::string mesh_name(size_t end) const {
    return fmt::format("{}_{}_mesh{}", stem_, which(end), std::filesystem::path(ends_[end].path).extension().string());
  }

  /// The mesh itself, in its place, as long as it is one.
  std::string mesh_text(size_t i) const {
    const LiquidEnd& end = ends_[i];
    const Vec3d extent = bounding_box(end.mesh).extent();
    const double voxel = std::max({extent.x, extent.y, extent.z}) / k_voxels;
    const std::string weld = end.weld > 0 ? fmt::format(", \"weld\": {:.9g}", end.weld) : "";
    Points weight;
    if (const Passage* to = time_.towards(i)) weight.insert(weight.end(), {{to->sets, 0}, {to->set, 1}});
    if (const Passage* from = time_.away_from(i)) weight.insert(weight.end(), {{from->melts, 1}, {from->molten, 0}});
    return end.placement.placed_text(fmt::format(R"({{ "kind": "sdf_mesh", "file": "{}", "voxel": {:.4g}, "crease": {}{}, "weight": {} }})",
                                                 mesh_name(i), voxel, k_crease_degrees, weld, time_.curve(weight)));
  }

  /// Between two meshes. `material` stands after a comma, or is empty.
  std::string passage_text(size_t i, const std::string& material) const {
    const Passage& p = time_.passages()[i];
    return fmt::format(R"({{ "kind": "liquid", "from": "{}", "to": "{}", "volume": "linear", "ends": "molten",
            "progress": {},
            "weight": {}{} }})",
                       cloud_name(i), cloud_name(i + 1), time_.curve({{p.leaves, 0}, {p.arrives, 1}}),
                       time_.curve({{p.melts, 0}, {p.molten, 1}, {p.sets, 1}, {p.set, 0}}), material);
  }

  /// From one fit to the last.
  std::string whole_way_text(const std::string& material) const {
    const size_t count = time_.passages().size();
    std::vector<std::string> through;
    Points progress;
    for (size_t i = 0; i < count; ++i) {
      if (i > 0) through.push_back(fmt::format("\"{}\"", cloud_name(i)));
      const Passage& p = time_.passages()[i];
      progress.insert(progress.end(), {{p.leaves, double(i) / double(count)}, {p.arrives, double(i + 1) / double(count)}});
    }
    const std::string between = through.empty() ? "" : fmt::format("\"through\": [{}], ", fmt::join(through, ", "));
    return fmt::format(R"({{ "kind": "liquid", "from": "{}", {}"to": "{}", "volume": "linear",
            "progress": {}{} }})",
                       cloud_name(0), between, cloud_name(count), time_.curve(progress), material);
  }

  /// Melt, flow, set: the weights of the meshes and of the liquids sum to 1, so at each end the field is the mesh's alone.
  std::string field_text() const {
    // A pattern is the liquid's own, so that it flows with it.
    const std::string material = is_pattern(o_.surface) ? fmt::format(", \"material\": \"{}\"", o_.surface) : "";
    if (!o_.ends_are_meshes) return whole_way_text(material);
    std::vector<std::string> children;
    for (size_t i = 0; i < ends_.size(); ++i) {
      children.push_back(mesh_text(i));
      if (i < time_.passages().size()) children.push_back(passage_text(i, material));
    }
    return fmt::format(R"({{ "kind": "blend"{}, "children": [
          {} ] }})",
                       material, fmt::join(children, ",\n          "));
  }

  std::string text() const {
    const FollowOptions how{int(time_.passages().size()), o_.is_loop};
    const CameraPath camera = follow(moments_of(ends_, time_, o_), o_.camera, o_.aspect, how);
    const std::string look = is_pattern(o_.surface)  ? ""
                             : o_.surface == "metal" ? ",\n      \"surface\": { \"kind\": \"metal\", \"roughness\": 0.15 }"
                                                     : fmt::format(",\n      \"surface\": \"{}\"", o_.surface);
    return fmt::format(
        R"(// Made by kelpie liquid. `kelpie kinds liquid` explains the words.{loop}
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
        fmt::arg("loop", o_.is_loop ? fmt::format(" A loop: after frame {} comes {}.", o_.last, o_.first) : ""),
        fmt::arg("first", o_.first), fmt::arg("last", o_.last), fmt::arg("camera", camera.text()), fmt::arg("lights", shot_lights_text()),
        fmt::arg("floor", shot_floor_text()), fmt::arg("field", field_text()), fmt::arg("look", look));
  }

  std::filesystem::path path_;
  std::string stem_;
  std::span<const LiquidEnd> ends_;
  LiquidSceneOptions o_;
  Timeline time_;
};

} // namespace

std::vector<FileToWrite> liquid_scene_files(const std::string& path, std::span<const LiquidEnd> ends, const LiquidSceneOptions& o) {
  return SceneWriter(path, ends, o).files();
}

} // namespace kelpie
