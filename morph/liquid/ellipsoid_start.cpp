#include "morph/liquid/ellipsoid_start.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numeric>

#include <Eigen/Eigenvalues>

#include "base/point_index.h"
#include "morph/liquid/probe_grid.h"
#include "morph/liquid/medial_axis.h"

namespace kelpie {

double knob(const char* name, double usual) {
  const char* s = std::getenv(name);
  return s ? std::atof(s) : usual;
}

namespace {

constexpr int k_plain_rounds = 5, k_shaped_rounds = 4, k_spacing_halvings = 9;
constexpr size_t k_nearest_clusters = 8, k_least_members = 4;
constexpr double k_layers[] = {1.0 / 6, 1.0 / 2, 5.0 / 6};

class Clusters {
public:
  Clusters(std::span<const FitSample> samples, double spacing, size_t count) : samples_(samples), spacing_(spacing) {
    const double depth = knob("DEPTH", 0.4) * spacing;
    for (const FitSample& s : samples) {
      depth_.push_back(std::min(s.inner, 2 * depth));
      places_.push_back(s.position - std::min(s.inner, depth) * s.normal);
      static const double in = knob("ADAPT", 0.5), out = knob("ADAPTOUT", 0);
      finer_.push_back(std::clamp(std::pow(s.inner / (2 * spacing), in) * std::pow(s.outer / k_most_outer, out), 0.4, 2.0));
    }
    seed(count);
    for (int i = 0; i < k_plain_rounds; ++i) assign_nearest(), move_centres();
    assign_nearest();
    shape();
    for (int i = 0; i < k_shaped_rounds; ++i) assign_shaped(), shape();
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
    Eigen::Matrix3d covariance;
    Eigen::Matrix3d inverse;
    double log_determinant = 0;
    size_t members = 0;
    double depth = 0; ///< the mean of its members'
  };

  /// Places no two of which are nearer than others, about `count`.
  void seed(size_t count) {
    double low = 0, high = 1;
    for (int k = 0; k < k_spacing_halvings; ++k) {
      const double d = k == 0 ? 0.05 : 0.5 * (low + high);
      std::vector<Vec3d> chosen = darts(d, count);
      if (chosen.size() > count)
        low = d;
      else
        high = d, centres_ = std::move(chosen);
      if (k == 0 && high == 1) high = 0.2;
    }
  }

  std::vector<Vec3d> darts(double distance, size_t limit) const {
    std::vector<Vec3d> chosen;
    std::vector<char> is_taken(places_.size(), 0);
    const PointIndex<Vec3d> index(places_);
    for (size_t i = 0; i < places_.size(); ++i) {
      if (is_taken[i]) continue;
      chosen.push_back(places_[i]);
      if (chosen.size() > limit) break;
      index.visit_within(places_[i], distance * finer_[i], [&](size_t k, double) { is_taken[k] = 1; });
    }
    return chosen;
  }

  void assign_nearest() {
    const PointIndex<Vec3d> index(centres_);
    owner_.clear();
    for (const Vec3d& x : places_) owner_.push_back(index.nearest(x));
  }

  void move_centres() {
    std::vector<Vec3d> sums(centres_.size(), Vec3d(0));
    std::vector<size_t> members(centres_.size(), 0);
    for (size_t i = 0; i < places_.size(); ++i) sums[owner_[i]] += places_[i], ++members[owner_[i]];
    for (size_t c = 0; c < sums.size(); ++c)
      if (members[c]) centres_[c] = sums[c] / double(members[c]);
  }

  /// Centres and covariances from the layers below the samples.
  void shape() {
    clusters_.assign(centres_.size(), {});
    for (Cluster& c : clusters_) c.covariance.setZero();
    for (int pass = 0; pass < 2; ++pass) {
      for (size_t i = 0; i < samples_.size(); ++i) {
        Cluster& c = clusters_[owner_[i]];
        for (const double layer : k_layers) {
          const Vec3d p = samples_[i].position - layer * depth_[i] * samples_[i].normal;
          if (pass == 0) {
            c.centre += p, ++c.members, c.depth += depth_[i];
          } else {
            const Vec3d d = p - c.centre;
            const Eigen::Vector3d v(d.x, d.y, d.z);
            c.covariance += v * v.transpose();
          }
        }
      }
      for (Cluster& c : clusters_)
        if (c.members > 0 && pass == 0) c.centre /= double(c.members), c.depth /= double(c.members);
    }
    for (size_t k = 0; k < clusters_.size(); ++k) {
      Cluster& c = clusters_[k];
      if (c.members == 0) continue;
      c.covariance /= double(c.members);
      c.covariance += 1e-8 * Eigen::Matrix3d::Identity();
      if (c.members < 3 * k_least_members) c.covariance += Eigen::Matrix3d::Identity() * (c.covariance.trace() / 9);
      c.inverse = c.covariance.inverse();
      c.log_determinant = std::log(c.covariance.determinant());
      centres_[k] = c.centre;
    }
  }

  void assign_shaped() {
    const PointIndex<Vec3d> index(centres_);
    const double fairness = knob("LOGDET", 0.5);
    for (size_t i = 0; i < samples_.size(); ++i) {
      double best = 1e300;
      index.visit_nearest(places_[i], k_nearest_clusters, [&](size_t k, double) {
        const Cluster& c = clusters_[k];
        if (c.members == 0) return;
        double sum = fairness * c.log_determinant;
        const Vec3d d = places_[i] - c.centre;
        const Eigen::Vector3d v(d.x, d.y, d.z);
        sum += v.dot(c.inverse * v);
        if (sum < best) best = sum, owner_[i] = k;
      });
    }
  }

  Ellipsoid ellipsoid(const Cluster& c) const {
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(c.covariance);
    const Eigen::Vector3d deviation = solver.eigenvalues().cwiseSqrt(); // ascending
    Eigen::Vector3d half;
    static const double thin_whole = knob("THINWHOLE", 3.2), thin_shell = knob("THIN", 6), wide = knob("WIDE", 8);
    const double thin = thin_whole + (thin_shell - thin_whole) * std::min(1.0, c.depth / (knob("THICK", 0.4) * spacing_));
    for (int k = 0; k < 3; ++k) half[k] = deviation[k] * (thin + (wide - thin) * std::clamp(deviation[k] / deviation[0] - 1, 0.0, 1.0));
    const Eigen::Matrix3d root = solver.eigenvectors() * half.cwiseInverse().asDiagonal() * solver.eigenvectors().transpose();
    Ellipsoid e;
    e.centre = c.centre;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) e.to_ball[j][i] = root(i, j);
    e.log_weight = std::log(1.2);
    return e;
  }

  std::span<const FitSample> samples_;
  double spacing_;
  std::vector<double> depth_; ///< down to which the clusters reach
  std::vector<Vec3d> places_; ///< below the samples: what is divided into clusters
  std::vector<double> finer_;
  std::vector<Vec3d> centres_;
  std::vector<size_t> owner_;
  std::vector<Cluster> clusters_;
};

/// The greatest weight with which fillers start, and how far they reach beyond the surface.
constexpr double k_filler_weight = 6;

} // namespace

std::vector<Ellipsoid> start_ellipsoids(std::span<const FitSample> samples, double area, size_t count) {
  return Clusters(samples, std::sqrt(area / static_cast<double>(count)), count).ellipsoids();
}

std::vector<Ellipsoid> fillers(const std::vector<Ellipsoid>& blobs, std::span<const FitSample> samples, double least, size_t most) {
  std::vector<MedialSphere> candidates;
  for (const FitSample& s : samples)
    for (const double share : {1.0, 0.6})
      if (share * s.inner > least) candidates.push_back({s.position - share * s.inner * s.normal, share * s.inner});
  std::stable_sort(candidates.begin(), candidates.end(), [](const auto& a, const auto& b) { return a.radius > b.radius; });
  std::vector<Vec3d> places;
  for (const auto& c : candidates) places.push_back(c.centre);
  if (places.empty()) return {};
  const ProbeGrid grid(places);
  std::vector<double> sums(places.size(), 0);
  const auto add = [&](const Ellipsoid& b) {
    grid.visit_in(b, [&](uint32_t i, const Vec3d& u) {
      const double q = 1 - glm::dot(u, u);
      sums[i] += std::exp(b.log_weight) * q * q;
    });
  };
  for (const Ellipsoid& b : blobs) add(b);
  std::vector<Ellipsoid> all;
  if (candidates.empty()) return all;
  for (size_t i = 0; i < candidates.size() && all.size() < most; ++i) {
    if (sums[i] > 1) continue;
    Ellipsoid b;
    b.centre = candidates[i].centre;
    b.to_ball = Mat3d(1 / (knob("FILL", 1.05) * candidates[i].radius));
    b.log_weight = std::log(k_filler_weight);
    all.push_back(b), add(b);
  }
  return all;
}

} // namespace kelpie
