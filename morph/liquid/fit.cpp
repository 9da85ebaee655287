#include "morph/liquid/fit.h"

#include <cmath>
#include <ctime>

#include <fmt/format.h>

#include "morph/liquid/ellipsoid_fitter.h"
#include "morph/liquid/fitter.h"
#include "morph/liquid/measure.h"
#include "morph/liquid/sphere_tree.h"

namespace kelpie {

namespace {

/// Points of the surface per round blob: for the sphere tree, and the share of them that the fit uses.
constexpr size_t k_dense_per_blob = 24, k_fitted_per_blob = 12;

/// At least so many samples, however few the blobs are.
constexpr size_t k_least_samples = 300;

/// The share of the time that a fit takes for its sphere tree or samples.
constexpr double k_tree_share = 0.2;

/// A fit that misses more of the mesh is none: of round blobs, and of ellipsoids.
constexpr double k_most_lost_round = 0.5, k_most_lost = 0.01;

/// Good enough: a fifth of what one sees, and what no reflection shows. A quarter of the blobs is tried first.
constexpr double k_fine_rms = 0.0004, k_fine_normals = 1.5;
constexpr size_t k_few = 4;

/// Where goals are: how many blobs come first, and by how much more are tried each time.
constexpr size_t k_first_for_goals = 125;
constexpr double k_more = 1.6;

/// Where two such steps make no error smaller than by this factor, more will not help.
constexpr double k_progress = 0.9;

double cpu_seconds() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

Ellipsoid to_ellipsoid(const BlobParameters& b) { return {centre_of(b), Mat3d(std::exp(-b[3])), b[4]}; }

Blob to_blob(const Ellipsoid& e, FitShape shape, double diagonal, const Vec3d& origin) {
  Blob b{Vec3(diagonal * e.centre + origin), 1, static_cast<float>(std::exp(e.log_weight)), Falloff::quartic};
  if (shape == FitShape::round)
    b.radius = static_cast<float>(diagonal / e.to_ball[0][0]);
  else
    set_ellipsoid(b, e.to_ball / diagonal); // its half axes are within limits
  return b;
}

/// Fits of one mesh, with as many blobs as one likes.
class MeshFit {
public:
  MeshFit(const Mesh& mesh, const FitOptions& options, const std::string& name)
      : options_(options), name_(name), diagonal_(bounding_box(mesh).diagonal()), unit_(scaled(mesh, diagonal_)), tree_(unit_),
        area_(surface_area(unit_)) {}

  FitResult run() {
    FitResult best;
    if (options_.has_goal()) {
      best = as_many_as_needed();
    } else {
      const size_t few = options_.blobs / k_few;
      if (options_.shape == FitShape::free && options_.may_use_fewer && few > 0) {
        best = fit(few);
        if (best.rms < k_fine_rms && best.normals < k_fine_normals && best.lost == 0) return best;
      }
      best = fit(options_.blobs);
      double lost_before = 1;
      while (options_.shape == FitShape::free && options_.may_use_fewer && best.lost > k_most_lost &&
             best.lost < k_progress * lost_before) {
        lost_before = best.lost;
        best = fit(more(k_most_fitted_blobs));
      }
    }
    refuse_if_lost(best);
    return best;
  }

private:
  static Mesh scaled(Mesh mesh, double diagonal) {
    for (Vec3d& p : mesh.positions) p /= diagonal;
    return mesh;
  }

  size_t more(size_t most) const { return std::min(most, static_cast<size_t>(k_more * static_cast<double>(fitted_)) + 1); }

  bool is_good(const FitResult& r) const {
    return (options_.error_share <= 0 || r.rms <= options_.error_share) &&
           (options_.error_length <= 0 || r.rms * diagonal_ <= options_.error_length) &&
           (options_.normals <= 0 || r.normals <= options_.normals) && r.lost <= k_most_lost;
  }

  FitResult as_many_as_needed() {
    FitResult r = fit(std::min(k_first_for_goals, options_.blobs));
    FitErrors before{1, 1, 180, 1, 1}, long_before = before;
    while (!is_good(r)) {
      const bool is_stuck = r.rms > k_progress * long_before.rms && r.normals > k_progress * long_before.normals;
      long_before = before, before = {r.rms, r.max, r.normals, r.lost, r.spurs};
      if (fitted_ >= options_.blobs || is_stuck)
        throw Error(ExitStatus::bad_data,
                    fmt::format("{} blobs are not enough: they are off by {:.3f} % of the diagonal and {:.1f} degrees (rms)",
                                r.blobs.size(), 100 * r.rms, r.normals),
                    {name_, 0, 0});
      r = fit(more(options_.blobs));
    }
    return r;
  }

  void refuse_if_lost(const FitResult& r) const {
    if (r.lost <= (options_.shape == FitShape::round ? k_most_lost_round : k_most_lost)) return;
    throw Error(
        ExitStatus::bad_data,
        fmt::format("the mesh is too thin for {} blobs: {:.0f} % of it would have no surface near (more blobs, or thicker walls, may help)",
                    fitted_, 100 * r.lost),
        {name_, 0, 0});
  }

  /// The seconds are those of all fits so far.
  FitResult fit(size_t count) {
    fitted_ = count;
    const std::vector<Ellipsoid> blobs = options_.shape == FitShape::round ? fit_round(count) : fit_free(count);
    const FitErrors errors = measure_fit(blobs, unit_, tree_, 2);
    FitResult result;
    result.sphere_tree_s = tree_s_, result.fit_s = fit_s_;
    result.rms = errors.rms, result.max = errors.max, result.normals = errors.normals;
    result.lost = errors.lost, result.spurs = errors.spurs;
    for (const Ellipsoid& b : blobs) result.blobs.push_back(to_blob(b, options_.shape, diagonal_, unit_.origin));
    return result;
  }

  std::vector<Ellipsoid> fit_free(size_t count) {
    const double start = cpu_seconds();
    std::vector<FitSample> samples = fit_samples(unit_, tree_, std::max(k_least_samples, EllipsoidFitter::k_samples_per_blob * count), 1);
    if (samples.empty()) refuse_hollow();
    report(k_tree_share);
    const double samples_done = cpu_seconds();
    tree_s_ += samples_done - start;
    std::vector<Ellipsoid> blobs =
        EllipsoidFitter(std::move(samples), area_).fit(count, [&](double done) { report(k_tree_share + (1 - k_tree_share) * done); });
    fit_s_ += cpu_seconds() - samples_done;
    return blobs;
  }

  std::vector<Ellipsoid> fit_round(size_t count) {
    const double start = cpu_seconds();
    std::vector<SurfaceSample> samples = spread_samples(unit_, k_dense_per_blob * count, 1);
    const SphereTree tree = build_sphere_tree(samples, tree_, count, options_.may_use_fewer);
    std::vector<MedialSphere> spheres;
    for (const SphereTree::Node& n : tree.finest()) spheres.push_back(n.sphere);
    if (spheres.empty()) refuse_hollow();
    report(k_tree_share);
    const double tree_done = cpu_seconds();
    tree_s_ += tree_done - start;
    samples.resize(std::min(samples.size(), k_fitted_per_blob * count)); // they come in no spatial order
    const std::vector<BlobParameters> fitted =
        Fitter(std::move(samples), tree_).fit(spheres, options_.may_use_fewer ? spheres.size() : count, [&](double done) {
          report(k_tree_share + (1 - k_tree_share) * done);
        });
    fit_s_ += cpu_seconds() - tree_done;
    std::vector<Ellipsoid> blobs;
    for (const BlobParameters& b : fitted) blobs.push_back(to_ellipsoid(b));
    return blobs;
  }

  [[noreturn]] void refuse_hollow() const {
    throw Error(ExitStatus::bad_data,
                "the mesh has no inside that could be filled with blobs: nearly all of it is thinner than 0.1 % of its diagonal",
                {name_, 0, 0});
  }

  /// Of several fits only what goes beyond those before counts.
  void report(double done) {
    const double share = std::min(1.0, done * static_cast<double>(fitted_) / static_cast<double>(options_.blobs));
    reported_ = std::max(reported_, share);
    options_.progress(reported_);
  }

  const FitOptions& options_;
  const std::string& name_;
  double diagonal_;
  Mesh unit_;
  TriangleTree tree_;
  double area_;
  size_t fitted_ = 0; ///< the number of blobs of the last fit
  double tree_s_ = 0, fit_s_ = 0, reported_ = 0;
};

} // namespace

FitResult fit_blobs(const Mesh& mesh, const FitOptions& options, const std::string& name) {
  const double diagonal = bounding_box(mesh).diagonal();
  if (!(std::abs(signed_volume(mesh)) > 1e-9 * diagonal * diagonal * diagonal))
    throw Error(ExitStatus::bad_data, "the mesh encloses no volume: there is nothing to fill with blobs", {name, 0, 0});
  return MeshFit(mesh, options, name).run();
}

} // namespace kelpie
