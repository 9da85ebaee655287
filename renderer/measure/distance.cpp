#include "renderer/measure/distance.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/parallel.h"

namespace kelpie {

namespace {

SurfaceDistance one_way(const Mesh& from, const TriangleTree& to) {
  constexpr size_t k_most = 4000;
  const size_t stride = std::max<size_t>(1, from.positions.size() / k_most), count = (from.positions.size() - 1) / stride + 1;
  std::vector<double> distances(count);
  parallel_for(size_t(0), count,
               [&](size_t i) { distances[i] = to.distance(from.positions[i * stride], std::numeric_limits<double>::infinity()); });
  SurfaceDistance d;
  for (const double x : distances) d.rms += x * x / double(count), d.largest = std::max(d.largest, x);
  d.rms = std::sqrt(d.rms);
  return d;
}

} // namespace

SurfaceDistance distance_between(const MeasuredMesh& a, const MeasuredMesh& b) {
  const SurfaceDistance there = one_way(a.mesh, b.tree), back = one_way(b.mesh, a.tree);
  return {std::sqrt((there.rms * there.rms + back.rms * back.rms) / 2), std::max(there.largest, back.largest)};
}

} // namespace kelpie
