#include "scene/check_axes.h"

#include <set>

#include <fmt/format.h>

#include "base/sample_record.h"
#include "field/warps/axis_tube.h"

namespace kelpie {

namespace {

/// The axes of an axial deformation, as they stand in the file.
const JsonValue::Array* axes_of(const ReadNode& n) {
  const JsonValue* axes = std::holds_alternative<Axial<AnimatedMode>>(n.node->kind) ? n.source->find("axes") : nullptr;
  return axes ? axes->array() : nullptr;
}

size_t count(const JsonValue& axis, std::string_view key) {
  const JsonValue* list = axis.find(key);
  return list && list->array() ? list->array()->size() : 0;
}

std::set<double> frames_of(const AxialAxis<AnimatedMode>& axis) {
  std::set<double> frames;
  for (const auto* list : {&axis.rest, &axis.deformed})
    for (const Animated<Vec3>& point : *list)
      for (const double frame : point.frames()) frames.insert(frame);
  if (frames.empty()) frames.insert(0);
  return frames;
}

} // namespace

void check_axes(const std::vector<ReadNode>& nodes, const Document& document, ProblemList& problems) {
  for (const ReadNode& n : nodes) {
    const JsonValue::Array* axes = axes_of(n);
    if (!axes) continue;
    for (const JsonValue& axis : *axes) {
      const size_t rest = count(axis, "rest"), deformed = count(axis, "deformed");
      if (rest > 1 && deformed > 1 && rest != deformed)
        problems.add(document.where(axis.find("deformed")->at),
                     fmt::format("deformed: expected as many points as rest has, {}, found {}", rest, deformed));
    }
  }
}

void warn_of_folds(const std::vector<ReadNode>& nodes, const Document& document, Diagnostics& diagnostics) {
  for (const ReadNode& n : nodes) {
    const JsonValue::Array* sources = axes_of(n);
    if (!sources) continue;
    const auto& axes = std::get<Axial<AnimatedMode>>(n.node->kind).axes;
    for (size_t i = 0; i < axes.size(); ++i) {
      double radius = double(axes[i].radius), at = 0, when = 0;
      const std::set<double> frames = frames_of(axes[i]);
      for (const double frame : frames) {
        const AxisTube tube(Axial<SampledMode>::shape(sample_record(axes[i], frame)));
        if (tube.cut_radius() < radius * (1 - 1e-6)) radius = tube.cut_radius(), at = tube.cut_at(), when = frame;
      }
      if (radius == double(axes[i].radius)) continue;
      diagnostics.warning(
          document.where((*sources)[i].at),
          fmt::format("the tube of this axis is cut to a radius of {:.3g} at {:.3g} of its length{}: a wider one would fold "
                      "space there",
                      radius, at, frames.size() > 1 ? fmt::format(" (frame {:g})", when) : ""));
    }
  }
}

} // namespace kelpie
