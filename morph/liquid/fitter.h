// From spheres to blobs.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "morph/liquid/least_squares.h"
#include "morph/liquid/medial_axis.h"

namespace kelpie {

/// Fits blobs to evenly spread surface samples (in units of the shape's diagonal).
class Fitter {
public:
  /// About twelve samples of the surface of `mesh` per blob determine its five parameters well.
  Fitter(std::vector<SurfaceSample> samples, const TriangleTree& mesh);

  /// At most `wanted` blobs that start as the spheres. `progress` is called with the share that is done.
  std::vector<BlobParameters> fit(std::span<const MedialSphere> spheres, size_t wanted, const std::function<void(double)>& progress) const;

private:
  void add_constraints(size_t sample);
  void balance_weights(std::vector<BlobParameters>&) const;
  void relocate(std::vector<FitBlob>&, size_t wanted) const;
  std::vector<size_t> by_usefulness(const std::vector<BlobParameters>&) const;
  std::vector<FitBlob> blobs_for_worst(const std::vector<BlobParameters>&, size_t most) const;
  double rms_estimate(const std::vector<BlobParameters>&) const;

  std::vector<SurfaceSample> samples_;
  std::vector<Poles> poles_;
  std::vector<Constraint> constraints_;
};

} // namespace kelpie
