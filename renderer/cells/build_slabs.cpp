#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "renderer/cells/cells.h"

namespace kelpie {

namespace {

/// Cells hold what passes through them in their slab, so they swell with the way that things go in it; more slabs take longer to
/// build. In radii of influence.
constexpr double k_most_motion = 0.51;
/// Blobs that move farther than this in a slab have two windows in it, which cost next to nothing but their boxes.
constexpr double k_most_in_window = 0.15;
/// The interpolation is at most this far from the motion in the middle of a slab and at its breaks: in radii of influence,
/// or relative for what is no length. Blurred, it does not show.
constexpr double k_tolerance = 0.005;
/// A slab ends this much earlier (of the open shutter), so that a step at its end belongs to the next.
constexpr double k_before_the_end = 1e-9;

/// A slab of time, in motion.
struct Slab {
  FieldProgram program;
  bool is_fine = true; ///< interpolation is good enough
  double moved = 0;    ///< in radii of influence
};

Slab make_slab(const CompileAt& compile_at, std::span<const double> breaks, uint32_t index, uint32_t slabs) {
  const double start = double(index) / slabs, end = double(index + 1) / slabs - k_before_the_end;
  std::vector<double> times{start};
  for (const double part : {0.25, 0.5, 0.75}) times.push_back(start + part * (end - start));
  for (const double t : breaks)
    if (t > start && t < end) times.push_back(t);
  std::sort(times.begin(), times.end());
  times.push_back(end);
  std::vector<FieldProgram> programs = compile_at(times);
  const auto is_nearer = [&](double a, double b) { return std::abs(2 * a - start - end) < std::abs(2 * b - start - end); };
  FieldProgram& middle = programs[size_t(std::min_element(times.begin(), times.end(), is_nearer) - times.begin())];
  Slab slab{std::move(programs.front())};
  slab.moved = difference(slab.program, programs.back()).place;
  if (!set_in_motion(slab.program, std::move(programs.back()), &middle.field)) { // turns too fast to interpolate
    slab.program = std::move(middle);
    slab.is_fine = false;
    return slab;
  }
  for (size_t i = 1; i + 1 < times.size(); ++i) {
    const FieldProgram& interpolated = at(slab.program, slab.program.code, (times[i] - start) / (end - start));
    slab.is_fine = slab.is_fine && difference(interpolated, programs[i]).most <= k_tolerance;
  }
  return slab;
}

/// Whether cells can be cut back by the time.
bool is_sum_of_travelling_blobs(const FieldProgram& program) {
  const std::vector<Instruction>& steps = program.code.steps;
  return program.motion && !program.motion->blobs_change && steps.size() == 1 && steps[0].kind == Instruction::Kind::blobs &&
         steps[0].space == 0;
}

/// So many slabs at least, for what moves so far in some number of them.
uint32_t slabs_for(double moved, uint32_t slabs, const CellLimits& limits) {
  const double wanted = std::min(double(limits.slabs), slabs * std::max(2.0, moved / k_most_motion));
  return std::bit_ceil(static_cast<uint32_t>(std::ceil(wanted)));
}

/// The first number of slabs to try. Where one is too few for how far things move, the ends alone show it.
uint32_t least_slabs(const CompileAt& compile_at, const CellLimits& limits) {
  if (limits.slabs <= 1) return 1;
  const std::vector<FieldProgram> ends = compile_at(std::array{0.0, 1 - k_before_the_end});
  const double moved = difference(ends[0], ends[1]).place;
  return moved <= k_most_motion ? 1 : slabs_for(moved, 1, limits);
}

} // namespace

Slabs build_slabs(const CompileAt& compile_at, std::span<const double> breaks, const CellLimits& limits) {
  for (uint32_t n = least_slabs(compile_at, limits);;) {
    std::vector<Slab> slabs;
    slabs.reserve(n);
    bool is_fine = true;
    double moved = 0;
    for (uint32_t i = 0; i < n && (is_fine || n >= limits.slabs); ++i) {
      slabs.push_back(make_slab(compile_at, breaks, i, n));
      is_fine = is_fine && slabs.back().is_fine && slabs.back().moved <= k_most_motion;
      moved = std::max(moved, slabs.back().moved);
    }
    if (is_fine || n >= limits.slabs) {
      const auto travels = [](const Slab& slab) { return is_sum_of_travelling_blobs(slab.program); };
      const bool has_windows = moved > k_most_in_window && std::all_of(slabs.begin(), slabs.end(), travels);
      Slabs out;
      for (uint32_t i = 0; i < n; ++i) {
        ShapeCells cells = build_cells(std::move(slabs[i].program), limits, has_windows ? 2 : 1);
        cells.slab_start = static_cast<float>(i) / static_cast<float>(n), cells.slabs = static_cast<float>(n);
        out.push_back(std::make_shared<const ShapeCells>(std::move(cells)));
      }
      return out;
    }
    n = slabs_for(moved, n, limits);
  }
}

} // namespace kelpie
