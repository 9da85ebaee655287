#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "base/atomic_file.h"
#include "base/float_step.h"
#include "base/standard_streams.h"
#include "cli/command.h"
#include "cli/failure.h"
#include "cli/fit_options.h"
#include "cli/number_check.h"
#include "field/clouds/cloud_file.h"
#include "morph/liquid/fit_cache.h"

namespace kelpie {

namespace {

constexpr size_t k_usual_blobs = 500;
constexpr double k_shown_steps = 10;

struct FitArguments : FitCommandOptions {
  std::string mesh, output, stats;
  unsigned threads = 0;
};

/// A length, or a percentage of the mesh's diagonal; false for anything else.
bool parse_error_goal(std::string text, double& share, double& length) {
  const bool is_percentage = !text.empty() && text.back() == '%';
  if (is_percentage) text.pop_back();
  double value = 0;
  if (!CLI::detail::lexical_cast(text, value) || !std::isfinite(value) || !(value > 0) || (is_percentage && value > 100)) return false;
  (is_percentage ? share : length) = is_percentage ? value / 100 : value;
  return true;
}

std::string check_error_goal(const std::string& text) {
  double share = 0, length = 0;
  if (parse_error_goal(text, share, length)) return {};
  return fmt::format("must be a length above 0 or a percentage of the mesh's diagonal, as in 0.1%, found {}", text);
}

FitOptions fit_options(const FitCommandOptions& options) {
  FitOptions how;
  how.weld = options.weld, how.shape = options.shape, how.normals = options.normals, how.may_use_fewer = options.blobs == 0;
  if (!options.error.empty()) parse_error_goal(options.error, how.error_share, how.error_length);
  how.blobs = options.blobs > 0 ? options.blobs : how.has_goal() ? k_most_fitted_blobs : k_usual_blobs;
  return how;
}

FitResult fit_with_progress(const MeshSource& mesh, const FitCommandOptions& options, Diagnostics& diagnostics) {
  Progress progress(options.progress, k_shown_steps, fmt::format("steps of fitting {}", mesh.label));
  FitOptions how = fit_options(options);
  how.progress = [&](double done) { progress.advance(k_shown_steps * done); };
  return fit_mesh_file(mesh.path, how, !options.no_cache, diagnostics);
}

std::string stats_of(const FitResult& r) {
  const nlohmann::ordered_json stats{{"version", KELPIE_VERSION},
                                     {"blobs", r.blobs.size()},
                                     {"sphere_tree_s", r.sphere_tree_s},
                                     {"fit_s", r.fit_s},
                                     {"rms", r.rms},
                                     {"max", r.max},
                                     {"normals", r.normals},
                                     {"lost", r.lost},
                                     {"spurs", r.spurs},
                                     {"cached", r.is_cached}};
  return stats.dump(2) + "\n";
}

void fit(const FitArguments& options) {
  require_writable(options.output);
  if (!options.stats.empty()) require_writable(options.stats);
  ReadOptions read;
  read.use_cache = !options.no_cache;
  MeshSources sources(read);
  const FitResult result = fit_and_report(sources.resolve(options.mesh), options);
  std::vector<FileToWrite> files{{options.output, blob_cloud_bytes(result.blobs)}};
  if (!options.stats.empty()) files.push_back({options.stats, stats_of(result)});
  write_files_atomically(files);
}

} // namespace

void add_fit_options(CLI::App& command, FitCommandOptions& o) {
  command
      .add_option("--blobs", o.blobs,
                  "how many blobs to fit; with --error or --normals at most [500, or fewer where they are as good; with a goal 20,000]")
      ->check(CLI::Range(size_t(1), k_most_fitted_blobs));
  command
      .add_option("--error", o.error,
                  "as many blobs as it takes for this distance from the mesh (rms): a length, or a percentage of its diagonal, as in 0.1%")
      ->check(CLI::Validator(check_error_goal, ""))
      ->option_text("LENGTH|PERCENT");
  command.add_option("--normals", o.normals, "as many blobs as it takes for normals that are off by so many degrees (rms)")
      ->check(number_between(0.01, 90))
      ->option_text("DEGREES");
  command
      .add_option_function<std::string>(
          "--shape", [&o](const std::string& name) { o.shape = name == "round" ? FitShape::round : FitShape::free; },
          "`round`: blobs are balls, as in the paper of Jin et al.; `free`: ellipsoids, whose normals are smooth and which keep thin "
          "sheets, but may leave pieces in the air: look at them [round]")
      ->check(CLI::IsMember({"free", "round"}))
      ->option_text("free|round");
  command
      .add_option(
          "--weld", o.weld,
          "vertices on open borders that are nearer to each other than this are one [a 10,000th of the mesh's diagonal, or a quarter "
          "of the shortest edge at either]")
      ->check(number_between(0))
      ->option_text("LENGTH");
}

FitResult fit_and_report(const MeshSource& mesh, const FitCommandOptions& options) {
  set_activity(fmt::format("fitting {}", mesh.label));
  Diagnostics diagnostics;
  FitResult r = fit_with_progress(mesh, options, diagnostics);
  if (r.lost > 0)
    diagnostics.warning({mesh.label, 0, 0}, fmt::format("{:.2g} % of the mesh have no surface near: more blobs may help", 100 * r.lost));
  if (r.spurs > 0)
    diagnostics.warning({mesh.label, 0, 0},
                        fmt::format("the field sticks out by 2 % of the diagonal over {:.2g} % of the mesh", 100 * r.spurs));
  Box3d box;
  for (const Blob& b : r.blobs) box.extend(Vec3d(b.centre));
  if (const double step = float_step_in(box); step > k_coarse_step)
    diagnostics.warning(
        {mesh.label, 0, 0},
        fmt::format("it lies so far from the origin that the places of blobs are rounded to {:.2g} of its size; move it there", step));
  print_warnings(diagnostics);
  print_message(
      fmt::format("{}: {} blobs, off by {:.3f} % of the diagonal (rms; at most {:.2f} %) and {:.1f} degrees; {}\n", mesh.label,
                  r.blobs.size(), 100 * r.rms, 100 * r.max, r.normals,
                  r.is_cached ? std::string("from the cache") : fmt::format("samples {:.1f} s, fit {:.1f} s", r.sphere_tree_s, r.fit_s)));
  return r;
}

void add_fit(CLI::App& app) {
  CLI::App& command = *app.add_subcommand("fit", "fit blobs to a mesh");
  auto options = std::make_shared<FitArguments>();
  command.add_option("MESH", options->mesh, k_mesh_sources)->required();
  command
      .add_option("-o,--output", options->output, "the cloud: a PLY file of vertices x y z radius weight, of ellipsoids ax … cz as well")
      ->required()
      ->check(ends_in(".ply"));
  add_fit_options(command, *options);
  command.add_flag("--no-cache", options->no_cache, "fit anew, and keep nothing in ~/.cache/kelpie");
  command.add_option("-j,--threads", options->threads, "accepted everywhere; a fit takes one thread")->check(CLI::Range(0, 4096));
  command.add_option("--stats", options->stats, "write the figures to a JSON file");
  add_progress_option(command, options->progress);
  command.footer("Examples:\n"
                 "  kelpie fit bunny.obj -o bunny_blobs.ply --blobs 500 --stats fit.json\n"
                 "  kelpie fit vases.json:amphora -o amphora_blobs.ply");
  command.callback([=] { fit(*options); });
}

} // namespace kelpie
