#include "renderer/measure/measure_morph.h"

#include <algorithm>

#include "renderer/program/surface_search.h"

namespace kelpie {

namespace {

/// How long before and after a frame speeds look, in frames: long enough for numbers that are float.
constexpr double k_instant = 1.0 / 16;
constexpr double k_counted_speeds = 0.999;

double speed_of(const Isosurface& surface) {
  std::vector<float> speeds = surface.speed;
  if (speeds.empty()) return 0;
  const auto at = speeds.begin() + static_cast<ptrdiff_t>(k_counted_speeds * double(speeds.size() - 1));
  std::nth_element(speeds.begin(), at, speeds.end());
  return *at;
}

std::optional<MeasuredMesh> measured(Mesh mesh) {
  if (mesh.triangles.empty()) return {};
  return MeasuredMesh(std::move(mesh));
}

} // namespace

MorphMeasurer::MorphMeasurer(const Scene& scene, size_t shape, std::vector<int> frames, int resolution)
    : scene_(scene), frames_(std::move(frames)) {
  scene_.shapes = {scene.shapes[shape]};
  Box3d box;
  for (const int frame : frames_) box.extend(surface_bounds(program_at(frame)));
  if (box.is_empty()) box = {Vec3d(-1), Vec3d(1)}; // nothing in any frame
  lattice_ = Lattice::around(box, resolution);
  first_ = measured(extract_surface(moment_at(frames_.front()), lattice_).mesh);
  last_ = measured(extract_surface(moment_at(frames_.back()), lattice_).mesh);
}

FieldProgram MorphMeasurer::program_at(double frame) const {
  FrameScene at = sample(scene_, frame);
  return compile(std::move(at.shapes[0].field), at.shapes[0].threshold);
}

FieldMoment MorphMeasurer::moment_at(double frame) const {
  return {program_at(frame), program_at(frame - k_instant), program_at(frame + k_instant), 2 * k_instant};
}

FieldMeasures MorphMeasurer::measure_next() {
  FieldMeasures out;
  out.frame = frames_[next_];
  Isosurface surface = extract_surface(moment_at(out.frame), lattice_);
  Parts parts = find_parts(surface, lattice_);
  out.parts = parts.parts, out.volume = parts.volume(), out.area = parts.area();
  for (const Part& part : parts.parts) out.genus += part.genus, out.cavities += part.cavities;
  out.speed = speed_of(surface);
  if (const auto now = measured(std::move(surface.mesh))) {
    if (first_) out.to_first = distance_between(*now, *first_);
    if (last_) out.to_last = distance_between(*now, *last_);
  }
  follow_parts(parts, out);
  before_ = std::move(parts);
  ++next_;
  return out;
}

void MorphMeasurer::follow_parts(const Parts& parts, FieldMeasures& out) {
  std::vector<size_t> tracks;
  if (next_ == 0) {
    for (size_t i = 0; i < parts.parts.size(); ++i) tracks.push_back(track_count_++);
    track_of_ = std::move(tracks);
    return;
  }
  const PartLinks links = link_parts(before_, parts);
  out.events = links.events;
  std::vector<bool> is_told(links.groups.size());
  for (size_t b = 0; b < parts.parts.size(); ++b) { // the largest part of a group tells of it
    const size_t a = links.earlier_of[b];
    tracks.push_back(a == PartLinks::k_none ? track_count_++ : track_of_[a]);
    const PartLinks::Group& group = links.groups[links.group_of[b]];
    if (is_told[links.group_of[b]]) continue;
    is_told[links.group_of[b]] = true;
    out.changes.push_back({tracks.back(), std::abs(group.after - group.before), parts.parts[b].centre});
  }
  for (const PartEvent& event : links.events)
    if (event.kind == PartEvent::Kind::vanishes) out.changes.push_back({track_of_[event.part], event.volume, event.place});
  track_of_ = std::move(tracks);
}

} // namespace kelpie
