#include "renderer/trace/build_scenes.h"

#include <algorithm>
#include <map>

#include "renderer/trace/exposure_states.h"

namespace kelpie {

namespace {

/// Where leaves have materials a hit must know which leaves made it.
CompileOptions options_for(const SampledField& field, const CellLimits& limits) {
  return {.with_identities = limits.with_identities || !field.materials.empty()};
}

/// The moments of a frame that were asked for.
class Moments {
public:
  explicit Moments(const FrameScene& frame) : frame_(frame), exposure_(frame.exposure()) {}

  const FrameScene& at(double time) {
    const auto [found, is_new] = moments_.try_emplace(time);
    if (is_new) found->second = frame_.moment(exposure_.frame_at(time));
    return found->second;
  }

private:
  const FrameScene& frame_;
  Exposure exposure_;
  std::map<double, FrameScene> moments_;
};

Slabs build_moving(Moments& moments, size_t shape, std::span<const double> breaks, const CellLimits& limits) {
  const CompileAt compile_at = [&](std::span<const double> times) {
    std::vector<SampledField> fields;
    std::vector<double> thresholds;
    for (const double t : times) {
      const SampledShape& s = moments.at(t).shapes[shape];
      fields.push_back(s.field), thresholds.push_back(s.threshold);
    }
    const CompileOptions options = options_for(fields[0], limits);
    return compile(std::move(fields), thresholds, options);
  };
  return build_slabs(compile_at, breaks, limits);
}

bool is_same(const PixelScale& a, const PixelScale& b) { return a.eye == b.eye && a.per_distance == b.per_distance; }

/// But for thin elements, which depend on the pixels.
bool makes_the_same(const CellLimits& a, const CellLimits& b) {
  return a.elements == b.elements && a.sparse_side == b.sparse_side && a.side_in_radii == b.side_in_radii && a.depth == b.depth &&
         a.with_identities == b.with_identities;
}

/// Builds the cells of a frame's shapes, or takes those of the last frame.
class CellBuilder {
public:
  CellBuilder(const FrameScene& frame, const CellLimits& limits, const KeptScenes& kept)
      : frame_(frame), exposure_(frame.exposure()), moments_(frame), limits_(limits), kept_(kept.cells) {
    if (exposure_.length > 0) {
      for (const double at : frame.breaks) breaks_.push_back((at - exposure_.start) / exposure_.length);
      looks_ = {0, 0.25, 0.5, 0.75, 1};
      for (const double t : breaks_)
        if (t > 0 && t < 1) looks_.push_back(t);
    }
    const bool fits = kept_ && kept_->shapes().size() == frame.shapes.size() && makes_the_same(kept.limits, limits) &&
                      kept.is_exposed == (exposure_.length > 0);
    if (!fits) kept_.reset();
    is_same_view_ = is_same(kept.limits.pixels, limits.pixels);
  }

  bool is_unchanged(size_t i) {
    if (!kept_) return false;
    const Slabs& last = kept_->shapes()[i];
    if (last[0]->depends_on_view && !is_same_view_) return false;
    if (last.size() > 1 || last[0]->program.motion || !is_equal(*last[0], frame_.shapes[i])) return false;
    return std::all_of(looks_.begin(), looks_.end(), [&](double t) { return is_equal(*last[0], moments_.at(t).shapes[i]); });
  }
  const Slabs& last(size_t i) const { return kept_->shapes()[i]; }
  /// What has changed makes room first.
  void forget() { kept_.reset(); }

  Slabs build(size_t i) {
    const SampledShape& shape = frame_.shapes[i];
    if (exposure_.length > 0 && !shape.field.nodes.empty()) return build_moving(moments_, i, breaks_, limits_);
    ShapeCells cells;
    if (shape.field.nodes.empty()) // geometry has no cells
      cells.program.threshold = shape.threshold;
    else
      cells = build_cells(compile(shape.field, shape.threshold, options_for(shape.field, limits_)), limits_);
    return {std::make_shared<const ShapeCells>(std::move(cells))};
  }

private:
  static bool is_equal(const ShapeCells& last, const SampledShape& shape) {
    return last.program.threshold == double(shape.threshold) && kelpie::is_equal(last.program.field, shape.field);
  }

  const FrameScene& frame_;
  Exposure exposure_;
  Moments moments_;
  const CellLimits& limits_;
  std::shared_ptr<const CellScene> kept_;
  bool is_same_view_ = false;
  std::vector<double> breaks_; ///< in the time of the exposure
  std::vector<double> looks_;  ///< when a shape must be the same to count as unchanged
};

} // namespace

std::shared_ptr<const CellScene> build_cell_scene(const FrameScene& frame, const CellLimits& limits, KeptScenes& kept, size_t& kept_cells) {
  CellBuilder builder(frame, limits, kept);
  std::vector<Slabs> all(frame.shapes.size());
  for (size_t i = 0; i < all.size(); ++i)
    if (builder.is_unchanged(i)) all[i] = builder.last(i);
  builder.forget();
  const bool is_all_kept = std::none_of(all.begin(), all.end(), [](const Slabs& s) { return s.empty(); });
  if (!is_all_kept) kept.cells.reset(); // what has changed makes room first
  for (size_t i = 0; i < all.size(); ++i) {
    if (limits.budget) limits.budget->enter(i);
    if (all[i].empty()) {
      all[i] = builder.build(i);
      continue;
    }
    const ShapeCells& cells = *all[i][0];
    kept_cells += cells.cells.size();
    if (limits.budget) limits.budget->take(cells.bytes() + cells.cells.size() * k_tree_bytes_per_cell);
  }
  if (!is_all_kept || !kept.cells) kept.cells = std::make_shared<const CellScene>(std::move(all));
  kept.limits = limits, kept.limits.budget = nullptr, kept.is_exposed = frame.exposure().length > 0;
  return kept.cells;
}

std::shared_ptr<const MeshScene> build_mesh_scene(const FrameScene& frame, const CellLimits& limits, KeptScenes& kept) {
  std::vector<MovingMesh> meshes;
  const auto place = [&](uint32_t shape, const FrameScene& at) { return std::get<TriangleMesh<SampledMode>>(*at.shapes[shape].geometry); };
  for (uint32_t i = 0; i < frame.shapes.size(); ++i)
    if (const auto& geometry = frame.shapes[i].geometry; geometry && std::holds_alternative<TriangleMesh<SampledMode>>(*geometry))
      meshes.push_back({i, {place(i, frame)}});
  if (const Exposure exposure = frame.exposure(); exposure.length > 0 && !meshes.empty()) {
    for (MovingMesh& mesh : meshes) mesh.states.clear();
    for (int i = 0; i < k_states; ++i) { // all meshes together: a moment of a scene may take a while
      const FrameScene at = frame.moment(exposure.frame_at(double(i) / (k_states - 1)));
      for (MovingMesh& mesh : meshes) mesh.states.push_back(place(mesh.shape, at));
    }
  }
  for (MovingMesh& mesh : meshes) {
    const auto stands = [&](const TriangleMesh<SampledMode>& state) { return is_same(state, mesh.states[0]); };
    if (std::all_of(mesh.states.begin(), mesh.states.end(), stands)) mesh.states.resize(1);
    if (limits.budget) limits.budget->enter(mesh.shape), limits.budget->take(estimated_bytes(mesh));
  }
  if (!kept.meshes || !kept.meshes->is_of(meshes)) {
    kept.meshes.reset();
    kept.meshes = std::make_shared<const MeshScene>(meshes);
  }
  return kept.meshes;
}

} // namespace kelpie
