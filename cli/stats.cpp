#include "cli/stats.h"

#include <fmt/format.h>

#include "base/atomic_file.h"
#include "base/file_bytes.h"

namespace kelpie {

namespace {

/// The work of each solver, as members of an object.
std::string solvers_text(const SolveCounters& counters) {
  std::vector<std::string> solvers;
  for (const auto& [name, work] : SolveCounters::k_solvers)
    solvers.push_back(
        fmt::format("\"{}\": {{\"cells\": {}, \"evaluations\": {}}}", name, (counters.*work).cells, (counters.*work).evaluations));
  return fmt::format("{}", fmt::join(solvers, ", "));
}

} // namespace

void write_render_stats(const std::string& path, unsigned threads, const std::vector<FrameReport>& reports) {
  std::string text = fmt::format("{{\n  \"version\": \"{}\",\n  \"threads\": {},\n  \"frames\": [", KELPIE_VERSION, threads);
  const char* separator = "\n";
  for (const FrameReport& r : reports) {
    const FrameStats& f = r.frame;
    const SolverWork total = f.rays.solve.total();
    text += fmt::format(
        "{}    {{\"frame\": {}, \"wall_s\": {:.4f}, \"build_cpu_s\": {:.4f}, \"render_cpu_s\": {:.4f}, \"output_cpu_s\": {:.4f},\n"
        "     \"rays\": {{\"camera\": {}, \"shadow\": {}, \"scatter\": {}}}, \"cells\": {}, \"kept_cells\": {}, \"coarsenings\": {}, "
        "\"elements\": {}, \"cells_solved\": {}, "
        "\"evaluations\": {},\n     \"solvers\": {{{}}},\n     \"axial\": {{\"inversions\": {}, \"newton_steps\": {}}},\n"
        "     \"nonfinite\": {}, \"engine_mb\": {:.1f}, \"peak_rss_mb\": {:.1f}}}",
        separator, f.frame, f.wall_s, f.build_cpu_s, f.render_cpu_s, r.output_cpu_s, f.rays.camera, f.rays.shadow, f.rays.scatter, f.cells,
        f.kept_cells, f.coarsenings, f.elements, total.cells, total.evaluations, solvers_text(f.rays.solve), f.rays.solve.axis.inversions,
        f.rays.solve.axis.newton_steps, f.nonfinite, static_cast<double>(f.engine_bytes) / 1e6, r.peak_rss_mb);
    separator = ",\n";
  }
  text += "\n  ]\n}\n";
  write_file_atomically(path, as_bytes(text));
}

} // namespace kelpie
