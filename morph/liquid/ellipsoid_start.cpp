#include "morph/liquid/ellipsoid_start.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Dense>

#include "base/point_index.h"
#include "morph/liquid/medial_axis.h"
#include "morph/liquid/probe_grid.h"

namespace kelpie {

namespace {

/// Clusters reach down to twice this share of their spacing; their seeds lie halfway.
constexpr double k_seed_depth = 0.4;

/// Where a shape is thinner than clusters are apart, they stand closer, by the root of it, within limits.
constexpr double k_closest = 0.4, k_sparsest = 2;

constexpr int k_round_sweeps = 5, k_shaped_sweeps = 4, k_spacing_halvings = 9;
constexpr size_t k_near_clusters = 8;

/// How much a cluster's size counts against taking a sample: with 1 it would be a mixture of Gaussians of equal weights.
constexpr double k_fairness = 0.5;

/// What lies below a sample, as shares of how deep it reaches.
constexpr double k_layers[] = {1.0 / 6, 1.0 / 2, 5.0 / 6};

/// Variances: at least so much. A cluster of fewer members is rounder than they tell.
constexpr double k_least_variance = 1e-8;
constexpr size_t k_few_members = 4;

/// Half axes in standard deviations: across a sheet, across what is as thick as 0.4 of the spacing, and along both.
constexpr double k_thin = 3.2, k_thick = 6, k_thick_depth = 0.4, k_wide = 8;

constexpr double k_first_weight = 1.2, k_filler_weight = 6, k_filler_reach = 1.05, k_least_filler = 0.7;

Eigen::Vector3d vector_of(const Vec3d& v) { return {v.x, v.y, v.z}; }

/// Samples in clusters, each as a Gaussian of what lies below its samples.
class Clusters {
public:
  Clusters(std::span<const FitSample> samples, double spacing, size_t count) : samples_(samples), spacing_(spacing) {
    for (const FitSample& s : samples) {
      depths_.push_back(std::min(s.inner, 2 * k_seed_depth * spacing));
      places_.push_back(s.position - std::min(s.inner, k_seed_depth * spacing) * s.normal);
      closeness_.push_back(std::clamp(std::sqrt(s.inner / (2 * spacing)), k_closest, k_sparsest));
    }
    seed(count);
    for (int i = 0; i < k_round_sweeps; ++i) assign_nearest(), move_centres();
    assign_nearest();
    shape();
    for (int i = 0; i < k_shaped_sweeps; ++i) assign_shaped(), shape();
  }

  std::vector<Ellipsoid> ellipsoids() const {
    std::vector<Ellipsoid> all;
    for (const Cluster& c : clusters_)
      if (c.members > 0) all.push_back(ellipsoid(c));
    return all;
  }

private:
  struct Cluster {
    Vec3d centre{0};
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero(), inverse = Eigen::Matrix3d::Identity();
    double log_determinant = 0;
    double depth = 0; ///< the mean of its members'
    size_t members = 0;
  };

  /// At most `count` places, evenly spread: the nearest together for which they are no more.
  void seed(size_t count) {
    double low = 0, high = 1;
    centres_ = darts(high, count);
    for (int k = 0; k < k_spacing_halvings; ++k) {
      const double d = k == 0 ? 2 * spacing_ : 0.5 * (low + high);
      std::vector<Vec3d> chosen = darts(d, count);
      if (chosen.size() > count)
        low = d;
      else
        high = d, centres_ = std::move(chosen);
    }
  }

  /// Stops at one more than `limit`.
  std::vector<Vec3d> darts(double distance, size_t limit) const {
    std::vector<Vec3d> chosen;
    std::vector<char> is_taken(places_.size(), 0);
    const PointIndex<Vec3d> index(places_);
    for (size_t i = 0; i < places_.size() && chosen.size() <= limit; ++i) {
      if (is_taken[i]) continue;
      chosen.push_back(places_[i]);
      index.visit_within(places_[i], distance * closeness_[i], [&](size_t k, double) { is_taken[k] = 1; });
    }
    return chosen;
  }

  void assign_nearest() {
    const PointIndex<Vec3d> index(centres_);
    owners_.clear();
    for (const Vec3d& p : places_) owners_.push_back(index.nearest(p));
  }

  void move_centres() {
    std::vector<Vec3d> sums(centres_.size(), Vec3d(0));
    std::vector<size_t> members(centres_.size(), 0);
    for (size_t i = 0; i < places_.size(); ++i) sums[owners_[i]] += places_[i], ++members[owners_[i]];
    for (size_t c = 0; c < sums.size(); ++c)
      if (members[c] > 0) centres_[c] = sums[c] / double(members[c]);
  }

  template <class Visit>
  void for_each_layer(Visit&& visit) {
    for (size_t i = 0; i < samples_.size(); ++i)
      for (const double layer : k_layers) visit(i, clusters_[owners_[i]], samples_[i].position - layer * depths_[i] * samples_[i].normal);
  }

  void shape() {
    clusters_.assign(centres_.size(), {});
    for_each_layer([&](size_t i, Cluster& c, const Vec3d& p) { c.centre += p, c.depth += depths_[i], ++c.members; });
    for (Cluster& c : clusters_)
      if (c.members > 0) c.centre /= double(c.members), c.depth /= double(c.members);
    for_each_layer([&](size_t, Cluster& c, const Vec3d& p) {
      const Eigen::Vector3d d = vector_of(p - c.centre);
      c.covariance += d * d.transpose();
    });
    for (size_t k = 0; k < clusters_.size(); ++k) {
      Cluster& c = clusters_[k];
      if (c.members == 0) continue;
      c.covariance /= double(c.members);
      double even = k_least_variance;
      if (c.members < k_few_members * std::size(k_layers)) even += c.covariance.trace() / 9;
      c.covariance += even * Eigen::Matrix3d::Identity();
      c.inverse = c.covariance.inverse();
      c.log_determinant = std::log(c.covariance.determinant());
      centres_[k] = c.centre;
    }
  }

  void assign_shaped() {
    const PointIndex<Vec3d> index(centres_);
    for (size_t i = 0; i < places_.size(); ++i) {
      double least = INFINITY;
      index.visit_nearest(places_[i], k_near_clusters, [&](size_t k, double) {
        const Cluster& c = clusters_[k];
        if (c.members == 0) return;
        const Eigen::Vector3d d = vector_of(places_[i] - c.centre);
        const double distance = d.dot(c.inverse * d) + k_fairness * c.log_determinant;
        if (distance < least) least = distance, owners_[i] = k;
      });
    }
  }

  Ellipsoid ellipsoid(const Cluster& c) const {
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(c.covariance);
    const Eigen::Vector3d deviation = solver.eigenvalues().cwiseMax(0.1 * k_least_variance).cwiseSqrt(); // ascending
    const double across = k_thin + (k_thick - k_thin) * std::min(1.0, c.depth / (k_thick_depth * spacing_));
    Eigen::Vector3d half;
    for (int k = 0; k < 3; ++k)
      half[k] = deviation[k] * (across + (k_wide - across) * std::clamp(deviation[k] / deviation[0] - 1, 0.0, 1.0));
    const Eigen::Matrix3d root = solver.eigenvectors() * half.cwiseInverse().asDiagonal() * solver.eigenvectors().transpose();
    Ellipsoid e{c.centre, Mat3d(1), std::log(k_first_weight)};
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) e.to_ball[j][i] = root(i, j);
    return e;
  }

  std::span<const FitSample> samples_;
  double spacing_;
  std::vector<double> depths_, closeness_;
  std::vector<Vec3d> places_; ///< below the samples: what is divided into clusters
  std::vector<Vec3d> centres_;
  std::vector<size_t> owners_;
  std::vector<Cluster> clusters_;
};

double spacing_of(double area, size_t count) { return std::sqrt(area / static_cast<double>(count)); }

} // namespace

std::vector<Ellipsoid> start_ellipsoids(std::span<const FitSample> samples, double area, size_t count) {
  return Clusters(samples, spacing_of(area, count), count).ellipsoids();
}

std::vector<Ellipsoid> fillers(const std::vector<Ellipsoid>& blobs, std::span<const FitSample> samples, double area, size_t count,
                               size_t most) {
  std::vector<MedialSphere> candidates;
  for (const FitSample& s : samples)
    for (const double share : {1.0, 0.6})
      if (const double r = share * s.inner; r > k_least_filler * spacing_of(area, count))
        candidates.push_back({s.position - r * s.normal, r});
  std::stable_sort(candidates.begin(), candidates.end(), [](const auto& a, const auto& b) { return a.radius > b.radius; });
  std::vector<Vec3d> places;
  for (const MedialSphere& c : candidates) places.push_back(c.centre);
  std::vector<Ellipsoid> balls;
  if (places.empty()) return balls;
  const ProbeGrid grid(places);
  std::vector<BlobValue> sums(places.size());
  const auto add = [&](const Ellipsoid& b) {
    grid.visit_in(b, [&](uint32_t i, const Vec3d& u) { add_value(b, std::exp(b.log_weight), u, sums[i]); });
  };
  for (const Ellipsoid& b : blobs) add(b);
  for (size_t i = 0; i < places.size() && balls.size() < most; ++i) {
    if (sums[i].value > 1) continue;
    balls.push_back({places[i], Mat3d(1 / (k_filler_reach * candidates[i].radius)), std::log(k_filler_weight)});
    add(balls.back());
  }
  return balls;
}

} // namespace kelpie
