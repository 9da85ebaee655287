#include <algorithm>
#include <filesystem>

#include <fmt/format.h>

#include "base/atomic_file.h"
#include "base/standard_streams.h"
#include "cli/command.h"
#include "cli/failure.h"
#include "cli/json_values.h"
#include "cli/progress.h"
#include "field/distances/mesh.h"
#include "morph/feature/match_parts.h"

namespace kelpie {

namespace {

/// Voxels of the fields that are written, in those that parts are found with: thin sheets show the coarser ones.
constexpr double k_field_voxels = 0.5;

namespace fs = std::filesystem;

struct FeaturesOptions {
  std::vector<std::string> meshes;
  std::string output, drawing;
  ProgressMode progress = ProgressMode::automatic;
  bool no_cache = false;
};

/// A mesh with its parts, both where and as large as in the scene: 1 high, on the floor, in the middle.
struct Solid {
  std::string file, name;
  Vec3d shift{0};
  double scale = 1, voxel = 1; ///< the latter of its field
  PartedSolid parts;
};

constexpr double k_steps = 1e4; ///< coordinates are rounded to a ten-thousandth

Solid load(const std::string& file, const FeaturesOptions& o, Diagnostics& diagnostics) {
  Solid solid;
  solid.file = file, solid.name = fs::path(file).stem().string();
  const auto grid = load_distance_grid(file, {}, !o.no_cache, diagnostics);
  solid.voxel = grid->voxel() * k_field_voxels;
  solid.parts.boxes = part_boxes(*grid);
  if (solid.parts.boxes.empty())
    throw Error(ExitStatus::bad_data, fmt::format("{}: nothing is inside it, or only what is thinner than {:.2g}", file, grid->voxel()));
  const Box3d padded = grid->box();
  for (const PartBox& part : solid.parts.boxes)
    for (int corner = 0; corner < 8; ++corner)
      solid.parts.box.extend(part.centre +
                             part.axes * (0.5 * part.size * Vec3d(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1)));
  solid.parts.box = intersect(solid.parts.box, padded);
  const Vec3d middle = solid.parts.box.centre();
  solid.shift = {-middle.x, -solid.parts.box.lower.y, -middle.z}, solid.scale = 1 / std::max(1e-12, solid.parts.box.extent().y);
  return solid;
}

/// The mesh as a field.
Json field_of(const Solid& solid, const fs::path& folder) {
  std::error_code error;
  const fs::path relative = fs::relative(solid.file, folder, error);
  const Json mesh{{"kind", "sdf_mesh"},
                  {"file", error || relative.empty() ? fs::absolute(solid.file).string() : relative.string()},
                  {"voxel", solid.voxel}};
  return {{"kind", "scale"},
          {"by", solid.scale},
          {"child", {{"kind", "translate"}, {"by", json_point(solid.shift, k_steps)}, {"child", mesh}}}};
}

Json element_of(const std::string& name, const Solid& solid, const PartBox& part) {
  Json e{{"name", name},
         {"centre", json_point(solid.scale * (part.centre + solid.shift), k_steps)},
         {"size", json_point(solid.scale * part.size, k_steps)}};
  if (part.axes != Mat3d(1.0)) e["axis"] = json_point(part.axes[1], k_steps), e["across"] = json_point(part.axes[0], k_steps);
  return e;
}

/// One solid, or several side by side over a width; about 1 high. The camera looks down so far that it sees the floor only.
Json scene_of(Json shapes, double width) {
  constexpr const char* k_ground = "#b9b4ac";
  shapes.push_back({{"name", "floor"}, {"geometry", {{"kind", "plane"}}}, {"surface", {{"kind", "matte"}, {"colour", k_ground}}}});
  const bool is_row = width > 1;
  const double away = is_row ? 0.8 * width : 3.1; // to the front
  return {{"kelpie", 1},
          {"camera", {{"position", {is_row ? 0.0 : 1.9, 0.5 + 0.45 * away, away}}, {"look_at", {0, 0.48, 0}}, {"fov", is_row ? 36 : 24}}},
          {"film", {{"resolution", {is_row ? 1280 : 640, 640}}, {"background", k_ground}}},
          {"lights",
           {{{"kind", "environment"}, {"preset", "studio"}},
            {{"kind", "sun"}, {"direction", {-1, 2.2, 1.6}}, {"strength", 1.6}, {"angle", 6}}}},
          {"shapes", std::move(shapes)}};
}

Json metamorphosis(const std::vector<Solid>& solids, const std::vector<ProposedFeature>& features, const fs::path& folder) {
  Json objects = Json::array();
  for (size_t j = 0; j < solids.size(); ++j) {
    Json elements = Json::array();
    for (const ProposedFeature& f : features)
      if (f.parts[j] >= 0) elements.push_back(element_of(f.name, solids[j], solids[j].parts.boxes[size_t(f.parts[j])]));
    objects.push_back({{"name", solids[j].name}, {"field", field_of(solids[j], folder)}, {"elements", elements}});
  }
  Json child{{"name", "child"},
             {"field", {{"kind", "metamorphosis"}, {"objects", objects}}},
             {"surface", {{"kind", "matte"}, {"colour", "#a8321f"}}}};
  return scene_of(Json::array({std::move(child)}), 1);
}

/// The edges of a box.
Json frame_of(const Solid& solid, const PartBox& part, const Vec3d& by) {
  Json edges = Json::array();
  const auto corner = [&](int i) {
    const Vec3d sign(i & 1 ? 0.5 : -0.5, i & 2 ? 0.5 : -0.5, i & 4 ? 0.5 : -0.5);
    return json_point(by + solid.scale * (part.centre + part.axes * (part.size * sign) + solid.shift), k_steps);
  };
  for (int i = 0; i < 8; ++i)
    for (int axis = 0; axis < 3; ++axis)
      if (const int j = i | 1 << axis; j != i)
        edges.push_back({{"kind", "sdf_capsule"}, {"from", corner(i)}, {"to", corner(j)}, {"capsule_radius", 0.004}});
  return {{"kind", "union"}, {"children", edges}};
}

/// A colour for each feature, alike for mirror images.
std::string colour_of(const std::string& name) {
  constexpr std::array<const char*, 8> k_colours{"#d1495b", "#2a9d8f", "#e9c46a", "#3d5a80", "#f4845f", "#7b5ea7", "#6a994e", "#00a6fb"};
  return k_colours[size_t(name.size() > 5 ? name[5] - 'a' : 0) % k_colours.size()];
}

/// All solids side by side, with the boxes of their features.
Json drawing(const std::vector<Solid>& solids, const std::vector<ProposedFeature>& features, const fs::path& folder) {
  Json shapes = Json::array();
  constexpr double k_step = 1.1;
  for (size_t j = 0; j < solids.size(); ++j) {
    const Vec3d by(k_step * (double(j) - 0.5 * double(solids.size() - 1)), 0, 0);
    shapes.push_back({{"name", fmt::format("{} {}", j + 1, solids[j].name)},
                      {"field", {{"kind", "translate"}, {"by", json_point(by, k_steps)}, {"child", field_of(solids[j], folder)}}},
                      {"surface", {{"kind", "matte"}, {"colour", "#d8d4cc"}}}});
    for (const ProposedFeature& f : features)
      if (f.parts[j] >= 0)
        shapes.push_back({{"name", fmt::format("{} {}", j + 1, f.name)},
                          {"field", frame_of(solids[j], solids[j].parts.boxes[size_t(f.parts[j])], by)},
                          {"surface", {{"kind", "matte"}, {"colour", colour_of(f.name)}}}});
  }
  return scene_of(shapes, std::max(2.0, k_step * double(solids.size())));
}

void propose(const FeaturesOptions& o) {
  set_activity("proposing features");
  if (o.meshes.size() < 2) throw Error(ExitStatus::usage, "features are proposed for two meshes or more");
  require_writable(o.output);
  if (!o.drawing.empty()) require_writable(o.drawing);
  std::vector<Solid> solids;
  std::vector<PartedSolid> parts;
  Diagnostics diagnostics;
  {
    Progress progress(o.progress, double(o.meshes.size()), "meshes");
    for (const std::string& file : o.meshes) {
      solids.push_back(load(file, o, diagnostics));
      parts.push_back(solids.back().parts);
      progress.advance(double(solids.size()), fmt::format("{}: {} parts", file, parts.back().boxes.size()));
    }
  }
  print_warnings(diagnostics);
  const std::vector<ProposedFeature> features = match_parts(parts);
  if (features.empty()) throw Error(ExitStatus::bad_data, "no two of the meshes have a part in common");
  const auto folder = [](const std::string& file) { return fs::absolute(file).parent_path(); };
  std::vector<FileToWrite> files;
  files.push_back({o.output, metamorphosis(solids, features, folder(o.output)).dump(1) + "\n"});
  if (!o.drawing.empty()) files.push_back({o.drawing, drawing(solids, features, folder(o.drawing)).dump(1) + "\n"});
  write_files_atomically(files);
  for (const ProposedFeature& f : features)
    print_message(fmt::format("{}: in {} of {} meshes\n", f.name,
                              std::count_if(f.parts.begin(), f.parts.end(), [](int p) { return p >= 0; }), solids.size()));
}

} // namespace

void add_features(CLI::App& app) {
  CLI::App& command = *app.add_subcommand("features", "propose the features of several meshes, and write the scene that breeds them");
  auto options = std::make_shared<FeaturesOptions>();
  command.add_option("MESHES", options->meshes, "two or more OBJ, PLY, OFF or STL files of one family, all upright (y) and facing alike")
      ->required()
      ->option_text("MESH...");
  command.add_option("-o,--output", options->output, "the scene: a metamorphosis of the meshes, with elements to edit")
      ->required()
      ->check(ends_in(".json"))
      ->option_text("SCENE.json");
  command.add_option("--draw", options->drawing, "another scene: the meshes side by side, with the elements' edges")
      ->check(ends_in(".json"))
      ->option_text("SCENE.json");
  command.add_flag("--no-cache", options->no_cache, "make the distances of meshes anew, and keep nothing in ~/.cache/kelpie");
  add_progress_option(command, options->progress);
  command.footer(
      R"(Divides each mesh into parts, finds which parts of the meshes are the same by where they are and how large, and left and right of each.
All meshes become 1 high and stand on the floor. What is proposed is text: move, rename and delete.

Examples:
  kelpie features chairs/*.off -o breed.json --draw elements.json
  kelpie sheet breed.json --random 12 -o new.png)");
  command.callback([=] { propose(*options); });
}

} // namespace kelpie
