#include <algorithm>
#include <cstdio>
#include <thread>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <tbb/global_control.h>

#include "base/atomic_file.h"
#include "base/standard_streams.h"
#include "base/suggest.h"
#include "cli/command.h"
#include "cli/failure.h"
#include "cli/mesh_report.h"
#include "cli/number_check.h"
#include "cli/progress.h"
#include "cli/read_options.h"
#include "colour/spaces.h"
#include "renderer/mesh/mesh_frame.h"
#include "renderer/mesh/print_check.h"
#include "renderer/output/mesh_file.h"
#include "scene/reader.h"

namespace kelpie {

namespace {

struct MeshCommandOptions {
  std::string scene, output, json, size, bed;
  std::vector<std::string> shapes;
  ReadOptions read;
  std::optional<int> frame;
  std::optional<double> tolerance, shell;
  double drain = MeshFrameOptions{}.drain;
  bool is_for_print = false;
  PrintLimits print;
  std::optional<size_t> triangles;
  int threads = 0;
  std::string ocio;
  ProgressMode progress = ProgressMode::automatic;
};

/// The shapes that are named, or all that have fields, in the scene's order; says what is left out.
std::vector<size_t> shapes_of(const Scene& scene, const MeshCommandOptions& o) {
  std::vector<std::string_view> fields, others;
  for (const Shape& s : scene.shapes) (s.field ? fields : others).push_back(s.name);
  if (fields.empty()) throw Error(ExitStatus::bad_data, "no shape has a field that could be meshed", {o.scene});
  for (const std::string& name : o.shapes)
    if (std::find(fields.begin(), fields.end(), name) == fields.end())
      throw Error(ExitStatus::usage, fmt::format("no shape with a field is called \"{}\"{}", name, suggestion(name, fields)));
  if (o.shapes.empty() && !others.empty()) print_message(fmt::format("left out, as ordinary geometry: {}\n", fmt::join(others, ", ")));
  std::vector<size_t> out;
  for (size_t i = 0; i < scene.shapes.size(); ++i) {
    const Shape& s = scene.shapes[i];
    if (s.field && (o.shapes.empty() || std::find(o.shapes.begin(), o.shapes.end(), s.name) != o.shapes.end())) out.push_back(i);
  }
  return out;
}

/// `200mm`, `20 cm`, `0.2m`; a number alone is in millimetres.
std::optional<double> millimetres(const std::string& text) {
  if (text.empty()) return {};
  size_t end = 0;
  double value = 0;
  try {
    value = std::stod(text, &end);
  } catch (const std::exception&) {
    end = 0;
  }
  const std::string unit = text.substr(std::min(text.find_first_not_of(' ', end), text.size()));
  for (const auto& [name, factor] : {std::pair("", 1.0), std::pair("mm", 1.0), std::pair("cm", 10.0), std::pair("m", 1000.0)})
    if (end > 0 && unit == name && std::isfinite(value) && value > 0) return value * factor;
  throw Error(ExitStatus::usage, fmt::format("--size: expected a length as 200mm, 20cm or 0.2m, found \"{}\"", text));
}

int frame_of(const Scene& scene, const MeshCommandOptions& o) {
  const auto [first, last, fps] = scene.frames;
  const int frame = o.frame.value_or(first);
  if (frame < first || frame > last)
    throw Error(ExitStatus::usage, fmt::format("-f: frame {} is not one of the scene's, which are {} to {}", frame, first, last));
  return frame;
}

/// Print files have z up.
UpAxis up_of(const MeshCommandOptions& o) {
  const MeshFormat format = mesh_format_of(o.output);
  return format == MeshFormat::stl || format == MeshFormat::threemf ? UpAxis::z : UpAxis::y;
}

/// `250x210x210`.
Vec3d bed_of(const MeshCommandOptions& o) {
  if (o.bed.empty()) return o.print.volume;
  Vec3d out(0);
  char rest = 0;
  if (std::sscanf(o.bed.c_str(), "%lfx%lfx%lf%c", &out.x, &out.y, &out.z, &rest) != 3 || !(out.x > 0 && out.y > 0 && out.z > 0))
    throw Error(ExitStatus::usage,
                fmt::format("--bed: expected three lengths in mm, the last one up, as 250x210x210, found \"{}\"", o.bed));
  return out;
}

MeshedFrame mesh_with_progress(const FrameScene& frame, const std::vector<size_t>& shapes, double units, const MeshCommandOptions& o) {
  constexpr double k_percent = 100;
  Progress progress(o.progress, k_percent, "% of meshing");
  MeshFrameOptions how;
  how.units = units, how.size = millimetres(o.size), how.tolerance = o.tolerance;
  if (o.triangles) how.most_triangles = *o.triangles;
  how.up = up_of(o), how.shell = o.shell, how.drain = o.drain;
  how.progress = [&](double done) { progress.advance(k_percent * done); };
  return mesh_frame(frame, shapes, how);
}

/// Leaves out what is empty, and says so; that everything is, is an error.
void remove_empty(std::vector<MeshObject>& objects, int frame, const MeshCommandOptions& o) {
  std::vector<std::string> empty;
  for (const MeshObject& object : objects)
    if (object.mesh.triangles.empty()) empty.push_back(object.name);
  if (empty.empty()) return;
  if (!o.shapes.empty() || empty.size() == objects.size())
    throw Error(
        ExitStatus::bad_data,
        fmt::format("nothing to mesh in frame {}: {} {} no surface", frame, fmt::join(empty, ", "), empty.size() == 1 ? "has" : "have"),
        {o.scene});
  Diagnostics diagnostics;
  for (const std::string& name : empty) diagnostics.warning({o.scene}, fmt::format("{} has no surface in frame {}", name, frame));
  print_warnings(diagnostics);
  std::erase_if(objects, [](const MeshObject& object) { return object.mesh.triangles.empty(); });
}

/// Throws an Error of all that is in the way, bad_data.
void require_printable(const MeshedFrame& meshed, const std::vector<Survey>& surveys, const MeshCommandOptions& o) {
  PrintLimits limits = o.print;
  limits.volume = bed_of(o);
  std::vector<Problem> problems;
  for (const std::string& line : print_problems(meshed.objects, surveys, meshed.lattice, up_of(o) == UpAxis::z ? 2 : 1, limits)) {
    Problem& problem = problems.emplace_back();
    problem.where.file = o.scene, problem.message = "not printable: " + line;
  }
  if (!problems.empty()) throw Error(ExitStatus::bad_data, std::move(problems));
}

void mesh(const MeshCommandOptions& o) {
  const unsigned threads = o.threads > 0 ? static_cast<unsigned>(o.threads) : std::thread::hardware_concurrency();
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
  const MeshFormat format = mesh_format_of(o.output);
  for (const std::string& output : {o.output, o.json})
    if (!output.empty()) require_writable(output);
  bed_of(o), millimetres(o.size); // wrong ones are said before there is work
  use_ocio_config(o.ocio);
  set_activity(fmt::format("reading {}", o.scene));
  Diagnostics diagnostics;
  const Scene scene = read_scene(o.scene, o.read, diagnostics);
  print_warnings(diagnostics);
  const int frame = frame_of(scene, o);
  const std::vector<size_t> shapes = shapes_of(scene, o);
  set_activity(fmt::format("meshing frame {}", frame));
  MeshedFrame meshed = mesh_with_progress(sample(scene, frame), shapes, scene.units, o);
  remove_empty(meshed.objects, frame, o);
  for (const std::string& name : meshed.too_thin_to_hollow)
    print_message(fmt::format("{} stays solid: it is nowhere thicker than two walls\n", name));
  set_activity("measuring walls");
  std::vector<Survey> surveys;
  for (const MeshObject& object : meshed.objects) surveys.push_back(survey(object.mesh));
  if (o.is_for_print) require_printable(meshed, surveys, o);
  set_activity(fmt::format("writing {}", o.output));
  std::vector<FileToWrite> files{{o.output, mesh_file_bytes(format, meshed.objects)}};
  if (!o.json.empty()) files.push_back({o.json, mesh_json(meshed, surveys)});
  write_files_atomically(files);
  print_result(mesh_summary(meshed.objects, surveys));
}

} // namespace

void add_mesh(CLI::App& app) {
  auto options = std::make_shared<MeshCommandOptions>();
  CLI::App& command = *app.add_subcommand("mesh", "the shapes of a frame as closed triangle meshes, for printing and other programs");
  command.footer("Examples:\n"
                 "  kelpie mesh vase.json -o vase.3mf --size 200mm --print --wall 1.2\n"
                 "  kelpie mesh morph.json -f 48 --shape drop -o drop.ply --tolerance 0.1 --triangles 100000");
  command.add_option("SCENE", options->scene, "the scene file (JSON)")->required();
  command.add_option("-o,--output", options->output, "the file to write: .ply, .3mf or .glb (with colours), .stl or .obj")->required();
  command.add_option("-f,--frame", options->frame, "the frame to mesh [the first of the scene]");
  command.add_option("--shape", options->shapes, "a shape to mesh; may be repeated [all that have fields]")->option_text("NAME");
  command.add_option("--size", options->size, "of the longest side of all together: 200mm, 20cm [the scene's units]")
      ->option_text("LENGTH");
  command.add_option("--tolerance", options->tolerance, "how far the mesh may lie from the surface, mm [a thousandth of the longest side]")
      ->check(number_between(1e-6))
      ->option_text("MM");
  command.add_option("--triangles", options->triangles, "at most so many, whatever the tolerance")->check(CLI::Range(4, 100'000'000));
  command.add_option("--shell", options->shell, "hollow, with walls of this thickness, mm")->check(number_between(0.01))->option_text("MM");
  command.add_option("--drain", options->drain, "diameter of the holes below cavities of --shell, mm; 0: none")
      ->check(number_between(0))
      ->option_text("MM")
      ->capture_default_str();
  command.add_flag("--print", options->is_for_print, "refuse what cannot be printed, saying why and where: --wall, --pieces, --bed");
  command.add_option("--wall", options->print.wall, "of --print: the thinnest wall, mm")
      ->check(number_between(0))
      ->option_text("MM")
      ->capture_default_str();
  command.add_option("--pieces", options->print.pieces, "of --print: pieces that a shape may be in")
      ->check(CLI::Range(1, 1'000'000))
      ->capture_default_str();
  command.add_option("--bed", options->bed, "of --print: what must hold all, mm, the last one up [250x210x210]")->option_text("XxYxZ");
  command.add_option("--json", options->json, "the summary as JSON")->check(ends_in(".json"))->option_text("OUT.json");
  command.add_option("-j,--threads", options->threads, "threads to use [all cores]")->check(CLI::Range(0, 4096));
  add_recipe_option(command, options->read);
  add_read_options(command, options->read);
  command.add_option("--ocio", options->ocio, "the OpenColorIO config [$OCIO, else kelpie's own]")->option_text("CONFIG");
  add_progress_option(command, options->progress);
  command.callback([options] { mesh(*options); });
}

} // namespace kelpie
