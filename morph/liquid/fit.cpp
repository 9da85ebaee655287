#include "morph/liquid/fit.h"

#include <cmath>
#include <ctime>

#include <fmt/format.h>

#include "morph/liquid/fitter.h"
#include "morph/liquid/measure.h"
#include "morph/liquid/sphere_tree.h"

namespace kelpie {

namespace {

/// Points of the surface per blob: for the sphere tree, and the share of them that the fit uses.
constexpr size_t k_dense_per_blob = 24, k_fitted_per_blob = 12;

/// The share of the time that a fit takes for its sphere tree.
constexpr double k_tree_share = 0.2;

/// A fit that misses more of the mesh is none.
constexpr double k_most_lost = 0.5;

double cpu_seconds() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

Blob to_blob(const BlobParameters& b, double diagonal, const Vec3d& origin) {
  return {Vec3(diagonal * centre_of(b) + origin), static_cast<float>(diagonal * std::exp(b[3])), static_cast<float>(std::exp(b[4])),
          Falloff::quartic};
}

} // namespace

FitResult fit_blobs(const Mesh& mesh, const FitOptions& options, const std::string& name) {
  const double diagonal = bounding_box(mesh).diagonal();
  if (!(std::abs(signed_volume(mesh)) > 1e-9 * diagonal * diagonal * diagonal))
    throw Error(ExitStatus::bad_data, "the mesh encloses no volume: there is nothing to fill with blobs", {name, 0, 0});
  Mesh unit = mesh;
  for (Vec3d& p : unit.positions) p /= diagonal;
  const TriangleTree tree_of_mesh(unit);

  FitResult result;
  const double start = cpu_seconds();
  std::vector<SurfaceSample> samples = spread_samples(unit, k_dense_per_blob * options.blobs, 1);
  const SphereTree tree = build_sphere_tree(samples, tree_of_mesh, options.blobs, options.may_use_fewer);
  std::vector<MedialSphere> spheres;
  for (const SphereTree::Node& n : tree.finest()) spheres.push_back(n.sphere);
  if (spheres.empty()) throw Error(ExitStatus::bad_data, "the mesh has no inside that could be filled with blobs", {name, 0, 0});
  options.progress(k_tree_share);
  const double tree_done = cpu_seconds();
  result.sphere_tree_s = tree_done - start;

  samples.resize(std::min(samples.size(), k_fitted_per_blob * options.blobs)); // they come in no spatial order
  const std::vector<BlobParameters> blobs =
      Fitter(std::move(samples), tree_of_mesh).fit(spheres, options.may_use_fewer ? spheres.size() : options.blobs, [&](double done) {
        options.progress(k_tree_share + (1 - k_tree_share) * done);
      });
  result.fit_s = cpu_seconds() - tree_done;

  const FitErrors errors = measure_fit(blobs, unit, tree_of_mesh, 2);
  result.rms = errors.rms, result.max = errors.max, result.lost = errors.lost, result.spurs = errors.spurs;
  if (errors.lost > k_most_lost)
    throw Error(
        ExitStatus::bad_data,
        fmt::format("the mesh is too thin for {} blobs: {:.0f} % of it would have no surface near (more blobs, or thicker walls, may help)",
                    options.blobs, 100 * errors.lost),
        {name, 0, 0});
  for (const BlobParameters& b : blobs) result.blobs.push_back(to_blob(b, diagonal, mesh.origin));
  return result;
}

} // namespace kelpie
