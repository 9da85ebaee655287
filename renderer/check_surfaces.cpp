#include "renderer/check_surfaces.h"

#include <array>

#include <fmt/format.h>

#include "morph/field_fold.h"
#include "renderer/peak.h"
#include "scene/document.h"

namespace kelpie {

namespace {

/// Work (see find_surface) for one shape in all frames, and for all shapes: 0.05 s and 0.3 s, about.
constexpr int64_t k_shape_work = 10'000'000, k_scene_work = 60'000'000;
/// To find the moment at which a field is largest.
constexpr int64_t k_peak_work = 100'000;
/// What sampling and compiling take, at least, and for each node.
constexpr int64_t k_moment_work = 10'000, k_node_work = 100;

/// The shape at one moment.
struct Moment {
  double frame = 0;
  SampledShape shape;
};

/// The node that one of SampledField::nodes was sampled from; null where the tree has fewer.
const FieldNode* node_sampled_as(size_t index, const FieldNode& root) {
  const FieldNode* found = nullptr;
  size_t count = 0;
  FieldFold<std::monostate> fold(PartsShared::in_one_time);
  fold(root, [&](const FieldNode& node, auto&&...) {
    if (count++ == index) found = &node;
    return std::monostate{};
  });
  return found;
}

class ShapeCheck {
public:
  ShapeCheck(const Scene& scene, const Shape& shape, std::span<const int> frames, int64_t work)
      : alone_(scene), shape_(shape), frames_(frames), work_(work) {
    alone_.shapes = {shape};
  }

  /// What there is to warn of, and where; no message for most shapes.
  Problem run() {
    // What comes and goes is likely to be there in the middle.
    for (const size_t i : k_looks)
      if (!is_nothing_in(look(i))) return at_threshold();
    for (const int frame : frames_)
      if (!is_nothing_in(frame)) return {};
    return {shape_.where, nothing()};
  }

  int64_t work_left() const { return work_; }

private:
  /// The middle, the last and the first of the frames.
  static constexpr std::array<size_t, 3> k_looks{1, 2, 0};
  int look(size_t i) const { return frames_[i * (frames_.size() - 1) / 2]; }

  bool is_nothing_in(double frame) {
    FrameScene at = sample(alone_, frame);
    const Exposure exposure = at.exposure();
    if (!is_nothing(std::move(at))) return false;
    if (exposure.length == 0) return true;
    return is_nothing(sample(alone_, exposure.start)) && is_nothing(sample(alone_, exposure.frame_at(1)));
  }

  /// Remembers the moment at which it is nearest to being something.
  bool is_nothing(FrameScene at) {
    SampledShape& shape = at.shapes[0];
    work_ -= k_moment_work + k_node_work * static_cast<int64_t>(shape.field.nodes.size());
    if (work_ < 0) return false;
    if (best_ && best_->shape.threshold == shape.threshold && is_equal(best_->shape.field, shape.field)) return true;
    const FieldProgram program = compile(shape.field, shape.threshold);
    const Surface surface = find_surface(program, work_);
    if (surface == Surface::present) at_threshold_ = skeleton_at_threshold(program);
    if (surface != Surface::none) return false;
    int64_t work = k_peak_work;
    const double peak = peak_of(program, work);
    work_ -= k_peak_work - work;
    is_constant_ = !best_;
    if (!best_ || peak / shape.threshold > peak_ / best_->shape.threshold) {
      best_ = {at.frame, std::move(shape)};
      peak_ = peak, weakest_leaf_ = peak_of_weakest_leaf(program);
    }
    return true;
  }

  std::string nothing() const {
    const double threshold = best_->shape.threshold;
    int64_t work = k_shape_work;
    const double peak = std::min(peak_, peak_of(compile(best_->shape.field, threshold), work));
    std::string text = fmt::format("shape {} has no surface: ", in_quotes(shape_.name));
    if (!(peak > 0)) return text + "its field is nowhere above 0";
    text += fmt::format("its field is at most {:.3g}{}, and its threshold is {:.3g}", peak,
                        is_constant_ ? "" : fmt::format(" (frame {:g})", best_->frame), threshold);
    const bool is_weak = weakest_leaf_ <= threshold * (1 + k_peak_margin);
    return text + (is_weak ? " (raise \"weight\", or lower \"threshold\")" : "");
  }

  /// Of a shape that has a surface in the frame that was looked at last.
  Problem at_threshold() const {
    for (const size_t i : k_looks) {
      if (!at_threshold_) return {};
      const FrameScene at = sample(alone_, look(i));
      if (!skeleton_at_threshold(compile(at.shapes[0].field, at.shapes[0].threshold))) return {};
    }
    const FieldNode* node = node_sampled_as(*at_threshold_, *shape_.field);
    if (!node) return {};
    const std::string_view name = std::visit([](const auto& kind) { return kind.k_name; }, node->kind);
    return {node->where,
            fmt::format("this {} of shape {} has no surface of its own: its field only reaches the threshold (raise \"weight\", "
                        "or lower \"threshold\")",
                        name, in_quotes(shape_.name))};
  }

  Scene alone_;
  const Shape& shape_;
  std::span<const int> frames_;
  int64_t work_;
  std::optional<Moment> best_;
  double peak_ = 0, weakest_leaf_ = 0;
  bool is_constant_ = true;
  std::optional<size_t> at_threshold_; ///< see skeleton_at_threshold
};

} // namespace

void warn_of_missing_surfaces(const Scene& scene, std::span<const int> frames, Diagnostics& diagnostics) {
  int64_t work = k_scene_work;
  for (const Shape& shape : scene.shapes) {
    if (!shape.field || work <= 0) continue;
    const int64_t share = std::min(work, k_shape_work);
    ShapeCheck check(scene, shape, frames, share);
    if (Problem problem = check.run(); !problem.message.empty()) diagnostics.warning(problem.where, problem.message);
    work -= share - check.work_left();
  }
}

} // namespace kelpie
