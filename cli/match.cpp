#include <algorithm>
#include <filesystem>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/atomic_file.h"
#include "base/standard_streams.h"
#include "base/suggest.h"
#include "cli/command.h"
#include "cli/failure.h"
#include "cli/match_text.h"
#include "cli/read_options.h"
#include "morph/field_fold.h"
#include "scene/generic_scene.h"

namespace kelpie {

namespace {

struct MatchOptions {
  std::string scene, shape, output, save_scene;
  std::optional<int> frame;
  ReadOptions read;
};

/// Each part once: one between two falloffs is two blobs, of which one has no weight yet.
MatchedLiquid matched(const LiquidMorph& morph, const SourcePosition& where) {
  BlobCloud from, to;
  morph.append_parts(0, from), morph.append_parts(1, to);
  MatchedLiquid liquid{where, {}, {}, {}};
  for (size_t i = 0; i < from.size(); ++i)
    if (from[i].weight != 0) liquid.from.push_back(from[i]), liquid.to.push_back(to[i]);
  return liquid;
}

/// Each passage of it by itself.
std::vector<MatchedLiquid> matched(const LiquidChain& chain, const SourcePosition& where) {
  std::vector<MatchedLiquid> all;
  for (const LiquidMorph& morph : chain.passages()) {
    all.push_back(matched(morph, where));
    all.back().passage = all.size(), all.back().passages = chain.passages().size();
  }
  return all;
}

std::vector<MatchedLiquid> liquids_of(const Scene& scene) {
  std::map<const FieldNode*, std::vector<MatchedLiquid>> found;
  for (const Shape& shape : scene.shapes) {
    const auto visit = [&]<class Kind>(const FieldNode& node, const Kind& kind, const auto&...) {
      if constexpr (std::is_same_v<Kind, Liquid<AnimatedMode>>) {
        if (!found.count(&node)) found.emplace(&node, matched(*kind.morph, node.where));
        for (MatchedLiquid& liquid : found.at(&node))
          if (liquid.shapes.empty() || liquid.shapes.back() != shape.name) liquid.shapes.push_back(shape.name);
      }
      return 0;
    };
    for (const FieldPtr& tree : {shape.field, shape.texture}) {
      FieldFold<int> fold(PartsShared::always);
      if (tree) fold(*tree, visit);
    }
  }
  std::vector<MatchedLiquid> liquids;
  for (auto& [node, of_node] : found)
    for (MatchedLiquid& liquid : of_node) liquids.push_back(std::move(liquid));
  const auto place = [](const MatchedLiquid& l) { return std::tuple(l.where.file, l.where.line, l.where.column, l.passage); };
  std::sort(liquids.begin(), liquids.end(), [&](const MatchedLiquid& a, const MatchedLiquid& b) { return place(a) < place(b); });
  return liquids;
}

/// Leaves what is in one shape: the one that is named, else the only one that changes into something.
void choose_shape(MatchReport& report, const Scene& scene, const MatchOptions& o) {
  std::vector<std::string_view> all, changing;
  const auto is_in = [](const auto& match, std::string_view shape) {
    return std::find(match.shapes.begin(), match.shapes.end(), shape) != match.shapes.end();
  };
  const auto changes = [&](std::string_view shape) {
    const auto is_in_it = [&](const auto& match) { return is_in(match, shape); };
    return std::any_of(report.trees.begin(), report.trees.end(), is_in_it) ||
           std::any_of(report.liquids.begin(), report.liquids.end(), is_in_it);
  };
  for (const Shape& shape : scene.shapes) {
    all.push_back(shape.name);
    if (changes(shape.name)) changing.push_back(shape.name);
  }
  if (!o.shape.empty() && std::find(all.begin(), all.end(), o.shape) == all.end())
    throw Error(ExitStatus::usage, fmt::format("no shape is called \"{}\"{}", o.shape, suggestion(o.shape, all)));
  if (changing.empty()) throw Error(ExitStatus::bad_data, "no shape has an animorphosis or a liquid", {o.scene});
  if (o.shape.empty() && changing.size() > 1)
    throw Error(ExitStatus::usage, fmt::format("which shape? One of {}", fmt::join(changing, ", ")));
  if (!o.shape.empty() && !changes(o.shape))
    throw Error(ExitStatus::usage,
                fmt::format("\"{}\" has no animorphosis or liquid: of all shapes only {}", o.shape, fmt::join(changing, ", ")));
  const std::string_view chosen = o.shape.empty() ? changing.front() : o.shape;
  const auto is_elsewhere = [&](const auto& match) { return !is_in(match, chosen); };
  std::erase_if(report.trees, is_elsewhere), std::erase_if(report.liquids, is_elsewhere);
}

/// Files that a scene names are relative to its folder.
void check_folder(const std::string& scene, const std::string& saved) {
  const auto folder = [](const std::string& file) {
    return std::filesystem::weakly_canonical(std::filesystem::absolute(file)).parent_path();
  };
  if (folder(scene) != folder(saved))
    throw Error(ExitStatus::usage, fmt::format("--save-scene: it names files relative to {}: save it there", folder(scene).string()));
  if (std::filesystem::weakly_canonical(scene) == std::filesystem::weakly_canonical(saved))
    throw Error(ExitStatus::usage, "--save-scene: that is the scene itself");
}

void check_usage(const MatchOptions& o) {
  if (o.output.empty() && o.save_scene.empty()) throw Error(ExitStatus::usage, "say -o OUT.json, -o OUT.svg, or --save-scene OUT.json");
  if (!o.output.empty()) require_writable(o.output);
  if (o.save_scene.empty()) return;
  if (o.save_scene == o.output) throw Error(ExitStatus::usage, "-o and --save-scene: both are to be " + o.output);
  if (!o.read.set.empty() || !o.read.recipe.empty())
    throw Error(ExitStatus::usage, "--save-scene writes what the file says: it goes with neither --set nor --recipe");
  check_folder(o.scene, o.save_scene);
  require_writable(o.save_scene);
}

void match(const MatchOptions& o) {
  check_usage(o);
  set_activity(fmt::format("reading {}", o.scene));
  Diagnostics diagnostics;
  MatchReport report{o.scene, o.frame, {}, {}};
  const Scene scene = read_scene_and_trees(o.scene, o.read, diagnostics, report.trees);
  print_warnings(diagnostics);
  const auto [first, last, fps] = scene.frames;
  if (o.frame && (*o.frame < first || *o.frame > last))
    throw Error(ExitStatus::usage, fmt::format("-f: frame {} is not one of the scene's, which are {} to {}", *o.frame, first, last));
  report.liquids = liquids_of(scene);
  std::vector<FileToWrite> files;
  std::string saved;
  if (!o.save_scene.empty()) {
    const GenericScene generic = generic_scene(o.scene, scene, report.trees);
    files.push_back({o.save_scene, generic.text});
    saved = fmt::format("{}: {} for {}, with {} values that move by {} keys, off by {:.2g} of a value at most\n", o.save_scene,
                        generic.trees == 1 ? "a tree" : fmt::format("{} trees", generic.trees),
                        generic.trees == 1 ? "its animorphosis" : "its animorphoses", generic.curves, generic.keys, generic.error);
  }
  choose_shape(report, scene, o);
  if (!o.output.empty()) {
    const bool is_picture = std::filesystem::path(o.output).extension() == ".svg";
    files.push_back({o.output, is_picture ? match_picture(report) : match_json(report)});
  }
  write_files_atomically(files);
  print_result(match_summary(report) + saved);
}

std::string ending_problem(const std::string& name) {
  const std::string ending = std::filesystem::path(name).extension().string();
  return ending == ".json" || ending == ".svg" ? "" : fmt::format("\"{}\" must end in .json or .svg", name);
}

} // namespace

void add_match(CLI::App& app) {
  auto options = std::make_shared<MatchOptions>();
  CLI::App& command = *app.add_subcommand("match", "which parts of a shape become which: of an animorphosis or a liquid (JSON, SVG)");
  command.footer(
      R"(A `.json` says of each match of an animorphosis, level by level, who corresponds (`by` a forced pair, by the least difference, by division of
a leaf, or by their places), how much they differ, what share of a divided node goes this way, and to what place what has no counterpart
shrinks, or from where it grows; of a liquid the pairs of blobs, and how much flows from the one to the other. A `.svg` shows both ends side
by side, with a line from each part to what it becomes. Places are in the space of the animorphosis, or of the liquid.

--save-scene writes the scene with an ordinary tree in the place of each animorphosis, whose numbers move by keys: to be edited like any other.
Between two curves of keys these are exact, and no more than both have together with `progress`.

Examples:
  kelpie match fish_to_bird.json -o match.svg
  kelpie match zoo.json dragon -f 40 -o match.json
  kelpie match fish_to_bird.json --save-scene fish_to_bird_keyed.json)");
  command.add_option("SCENE", options->scene, "the scene file (JSON)")->required();
  command.add_option("SHAPE", options->shape, "the shape [the only one with an animorphosis or a liquid]");
  command.add_option("-o,--output", options->output, "the file to write: .json (data) or .svg (a picture)")
      ->check(CLI::Validator([](std::string& name) { return ending_problem(name); }, ""))
      ->option_text("OUT.{json,svg}");
  command.add_option("--save-scene", options->save_scene, "write the scene with an ordinary tree in the place of each animorphosis")
      ->check(CLI::Validator([](std::string& name) { return name.ends_with(".json") ? "" : fmt::format("\"{}\" must end in .json", name); },
                             ""))
      ->option_text("OUT.json");
  command.add_option("-f,--frame", options->frame, "the frame at which places are shown [half way through the morph]")->option_text("N");
  add_read_options(command, options->read);
  add_recipe_option(command, options->read);
  command.callback([options] { match(*options); });
}

} // namespace kelpie
