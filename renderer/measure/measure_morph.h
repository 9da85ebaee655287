// A shape that changes, measured frame by frame.
#pragma once

#include <optional>
#include <span>

#include "renderer/measure/distance.h"
#include "renderer/measure/parts.h"

namespace kelpie {

/// What is measured of a shape's field in one frame. Lengths in scene units.
struct FieldMeasures {
  int frame = 0;
  double volume = 0, area = 0;
  int genus = 0, cavities = 0;                      ///< of all parts together
  std::vector<Part> parts;                          ///< the largest first
  std::vector<PartEvent> events;                    ///< since the frame before
  double speed = 0;                                 ///< see MorphMeasurer
  std::optional<SurfaceDistance> to_first, to_last; ///< to the surfaces of the first and the last frame; none where either has none
  /// How much the volume changed of each group of parts that belong together since the frame before, by the frames' parts and those that
  /// are gone. See PartLinks.
  struct PartChange {
    size_t track = 0; ///< numbers the parts as they go on from frame to frame
    double change = 0;
    Vec3d place{0};
  };
  std::vector<PartChange> changes;
};

/// Samples the field of one of a scene's shapes on one lattice for all frames, `resolution` cells along the longest side of all they
/// enclose. The scene must outlive it.
///
/// The speed of a frame is the largest with which its surface moves along its normal, scene units a frame, but for the thousandth of it
/// that is the fastest: where parts meet or break it has no bound.
class MorphMeasurer {
public:
  /// Throws Error, bad_data, for a field without an end. Runs in the current TBB arena, as measure() does.
  MorphMeasurer(const Scene& scene, size_t shape, std::vector<int> frames, int resolution);

  /// The next frame, in their order.
  FieldMeasures measure_next();

private:
  FieldProgram program_at(double frame) const;
  FieldMoment moment_at(double frame) const;
  void follow_parts(const Parts& parts, FieldMeasures& out);

  Scene scene_; ///< with the one shape
  std::vector<int> frames_;
  Lattice lattice_;
  std::optional<MeasuredMesh> first_, last_;
  size_t next_ = 0;
  Parts before_;
  std::vector<size_t> track_of_; ///< of each part of the frame before
  size_t track_count_ = 0;
};

} // namespace kelpie
