#include "cli/liquid_scene.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include <fmt/format.h>

#include "base/error.h"
#include "base/standard_streams.h"
#include "field/clouds/cloud_file.h"
#include "morph/liquid/interpolate.h"
#include "morph/liquid/volume.h"
#include "scene/parameter_types.h"

namespace kelpie {

namespace {

constexpr float k_size = 3, k_most_size_ratio = 1.5f;
constexpr double k_fov = 30, k_pi = 3.14159265358979323846;
/// From where one looks: a little from the right, and from so far above that the floor has no horizon.
const Vec3d k_view = glm::normalize(Vec3d(0.35, 0.4, 1));
constexpr double k_margin = 1.15;
/// The share of the frames for which either end is held.
constexpr double k_hold = 0.08;

/// What lies far from nearly all of a cloud decides how large it is shown.
void warn_of_specks(const CloudExtent& e, const char* which) {
  constexpr float k_dot = 0.1f;
  if (e.bulk.diagonal() > k_dot * e.box.diagonal()) return;
  const Vec3 c = e.bulk.centre();
  print_message(fmt::format(
      "warning: nearly all of the {} mesh, around ({:.4g}, {:.4g}, {:.4g}), is {:.2g} of its size: a speck far from it makes it "
      "a dot; remove what is small and far away\n",
      which, c.x, c.y, c.z, e.bulk.diagonal() / e.box.diagonal()));
}

CloudExtent checked_extent(const BlobCloud& cloud, const char* which) {
  const CloudExtent e = extent_of(cloud);
  if (e.box.is_empty()) throw Error(ExitStatus::bad_data, fmt::format("the {} cloud has no surface", which));
  warn_of_specks(e, which);
  return e;
}

void scale_and_stand(BlobCloud& cloud, const Box3& box, float scale) {
  const Vec3 foot(box.centre().x, box.lower.y, box.centre().z);
  for (Blob& b : cloud) b.centre = (b.centre - foot) * scale, b.radius *= scale;
}

struct View {
  Vec3d position{0}, look_at{0};
};

/// As near as possible with nine moments of the morph in the picture.
View frame_morph(const BlobCloud& from, const BlobCloud& to, double aspect) {
  constexpr int k_moments = 8;
  const LiquidMorph morph(from, to, Correspondence::transport, VolumeRule::linear);
  std::vector<Vec3> seen;
  for (int i = 0; i <= k_moments; ++i) {
    BlobCloud cloud;
    morph.append_blobs(static_cast<float>(i) / k_moments, cloud);
    const std::vector<Vec3> points = points_inside(cloud);
    seen.insert(seen.end(), points.begin(), points.end());
  }
  Box3d box;
  for (const Vec3& p : seen) box.extend(Vec3d(p));
  View view;
  view.look_at = box.centre();
  const Vec3d right = glm::normalize(glm::cross(Vec3d(0, 1, 0), k_view)), up = glm::cross(k_view, right);
  const double tangent = std::tan(k_fov / 2 * k_pi / 180);
  double distance = 0;
  for (const Vec3& point : seen) {
    const Vec3d p = Vec3d(point) - view.look_at;
    const double half = std::max(std::abs(glm::dot(p, up)), std::abs(glm::dot(p, right)) / aspect);
    distance = std::max(distance, glm::dot(p, k_view) + half * k_margin / tangent);
  }
  view.position = view.look_at + distance * k_view;
  return view;
}

bool is_pattern(std::string_view name) {
  const std::vector<std::string_view> patterns = kind_names<PatternKinds>();
  return std::find(patterns.begin(), patterns.end(), name) != patterns.end();
}

std::string progress_keys(int first, int last) {
  const int hold = static_cast<int>(std::lround(k_hold * (last - first)));
  return fmt::format(R"({{ "keys": [[{}, 0, 0], [{}, 1, 0]], "interpolation": "hermite" }})", first + hold,
                     std::max(last - hold, first + hold + 1));
}

} // namespace

BlobCloud turned_upright(BlobCloud cloud, const std::string& up) {
  for (Blob& b : cloud) {
    const Vec3 p = b.centre;
    if (up == "-y") b.centre = {p.x, -p.y, -p.z};
    if (up == "+z") b.centre = {p.x, p.z, -p.y};
    if (up == "-z") b.centre = {p.x, -p.z, p.y};
    if (up == "+x") b.centre = {-p.y, p.x, p.z};
    if (up == "-x") b.centre = {p.y, -p.x, p.z};
  }
  return cloud;
}

void place_together(BlobCloud& from, BlobCloud& to) {
  const CloudExtent a = checked_extent(from, "first"), b = checked_extent(to, "second");
  const float size_a = a.box.diagonal(), size_b = b.box.diagonal();
  // The factor of the second cloud relative to the first.
  const float by_volume = static_cast<float>(std::cbrt(a.volume / b.volume)), by_size = size_a / size_b;
  const float ratio = std::clamp(by_volume, by_size / k_most_size_ratio, by_size * k_most_size_ratio);
  const float scale = k_size / std::max(size_a, ratio * size_b);
  scale_and_stand(from, a.box, scale);
  scale_and_stand(to, b.box, scale * ratio);
}

std::vector<FileToWrite> liquid_scene_files(const std::string& path, const BlobCloud& from, const BlobCloud& to,
                                            const LiquidSceneOptions& o) {
  namespace fs = std::filesystem;
  const fs::path folder = fs::path(path).parent_path();
  const std::string stem = fs::path(path).stem().string();
  const View view = frame_morph(from, to, o.aspect);
  // A pattern is the liquid's own, so that it flows with it.
  const bool flows = is_pattern(o.surface);
  const std::string material = flows ? fmt::format(",\n        \"material\": \"{}\"", o.surface) : "";
  const std::string look = flows                  ? ""
                           : o.surface == "metal" ? ",\n      \"surface\": { \"kind\": \"metal\", \"roughness\": 0.15 }"
                                                  : fmt::format(",\n      \"surface\": \"{}\"", o.surface);
  const std::string text = fmt::format(
      R"(// Made by kelpie liquid. `kelpie kinds liquid` explains the words.
{{
  "kelpie": 1,
  "frames": {{ "first": {first}, "last": {last}, "fps": 24 }},
  "camera": {{ "position": [{px:.4f}, {py:.4f}, {pz:.4f}], "look_at": [{lx:.4f}, {ly:.4f}, {lz:.4f}], "fov": {fov} }},
  "film": {{ "resolution": [1280, 720], "spp": 64, "bounces": 4, "background": [0.01, 0.01, 0.012] }},
  "lights": [
    {{ "kind": "environment", "preset": "studio" }}
  ],
  "shapes": [
    {{
      "name": "liquid",
      "threshold": 1,
      "field": {{
        "kind": "liquid",
        "from": "{stem}_from.ply",
        "to": "{stem}_to.ply",
        "volume": "linear",
        "progress": {progress}{material}
      }}{look}
    }},
    {{
      "name": "floor",
      "geometry": {{ "kind": "plane", "position": [0, 0, 0] }},
      "surface": {{ "kind": "metal", "colour": [0.03, 0.03, 0.035], "roughness": 0.5 }}
    }}
  ]
}}
)",
      fmt::arg("first", o.first), fmt::arg("last", o.last), fmt::arg("px", view.position.x), fmt::arg("py", view.position.y),
      fmt::arg("pz", view.position.z), fmt::arg("lx", view.look_at.x), fmt::arg("ly", view.look_at.y), fmt::arg("lz", view.look_at.z),
      fmt::arg("fov", k_fov), fmt::arg("stem", stem), fmt::arg("progress", progress_keys(o.first, o.last)), fmt::arg("look", look),
      fmt::arg("material", material));
  return {{folder / (stem + "_from.ply"), blob_cloud_bytes(from)}, {folder / (stem + "_to.ply"), blob_cloud_bytes(to)}, {path, text}};
}

} // namespace kelpie
