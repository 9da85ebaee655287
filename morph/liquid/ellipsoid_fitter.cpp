#include "morph/liquid/ellipsoid_fitter.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <Eigen/Eigenvalues>

#include "morph/liquid/ellipsoid_start.h"

namespace kelpie {

namespace {

/// Distances outside the surface at which there must be no field.
constexpr double k_kept_free = 0.02;

/// The share of the blobs that the fit starts with; the others come where the error is largest, in so many splits. Halves of a blob in a
/// bent sheet leave it: the more of the surface has a sheet below that is thin, as a share of the spacing, the more blobs are there at
/// once.
constexpr double k_first_share = 0.7, k_first_of_sheets = 0.5, k_most_first = 0.95, k_thin_sheet = 0.15;
constexpr size_t k_splits = 2;

/// Steps of the solver before each split, and after the last.
constexpr int k_early_steps = 5, k_late_steps = 10;

/// Of the fillers at first.
constexpr size_t k_one_filler_in = 4;

constexpr int k_weight_sweeps = 8;
constexpr double k_weight_step = 0.7, k_least_balanced = 0.1, k_most_balanced = 10;

/// A blob's halves: how long they are, how far from the middle, and what they weigh, as shares; about the same sum.
constexpr double k_half_length = 0.75, k_half_place = 0.28, k_half_weight = 0.62;

/// The error of one sample counts as no more than so many units.
constexpr double k_most_error = 10;

std::pair<Vec3d, Vec3d> across(const Vec3d& n) {
  const Vec3d a = glm::normalize(glm::cross(n, std::abs(n.x) < 0.6 ? Vec3d(1, 0, 0) : Vec3d(0, 1, 0)));
  return {a, glm::cross(n, a)};
}

/// The samples, then what is known beside them: the balls that touch the surface are free of it.
EllipsoidSolver make_solver(const std::vector<FitSample>& samples) {
  std::vector<Vec3d> places;
  std::vector<Probe> probes;
  const auto add = [&](const Vec3d& p, const Probe& probe) { places.push_back(p), probes.push_back(probe); };
  for (const FitSample& s : samples) {
    const auto [a, b] = across(s.smooth);
    add(s.position, {has_normal(s) ? Probe::Kind::normal : Probe::Kind::surface, {a, b, s.smooth}});
  }
  for (size_t i = 0; i < samples.size(); ++i) {
    const FitSample& s = samples[i];
    const double out = std::min(i % 2 ? k_kept_free : 2 * k_kept_free, s.outer);
    if (out > 0.25 * k_kept_free) add(s.position + out * s.normal, {Probe::Kind::outside, {}});
    const double in = i % 2 ? s.inner : std::min(0.4 * s.inner, k_kept_free);
    add(s.position - in * s.normal, {Probe::Kind::inside, {}});
  }
  return EllipsoidSolver(std::move(places), std::move(probes));
}

/// Divides a blob in two along its longest axis.
Ellipsoid split(Ellipsoid& b) {
  Eigen::Matrix3d m;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) m(i, j) = b.to_ball[j][i];
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(m); // ascending: the first axis is the longest
  const Eigen::Vector3d axis = solver.eigenvectors().col(0);
  const double stretch = solver.eigenvalues()[0];
  m += (1 / k_half_length - 1) * stretch * axis * axis.transpose();
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) b.to_ball[j][i] = m(i, j);
  b.log_weight += std::log(k_half_weight);
  const Vec3d away = k_half_place / stretch * Vec3d(axis[0], axis[1], axis[2]);
  Ellipsoid other = b;
  b.centre += away, other.centre -= away;
  return other;
}

} // namespace

EllipsoidFitter::EllipsoidFitter(std::vector<FitSample> samples, double area)
    : samples_(std::move(samples)), area_(area), solver_(make_solver(samples_)) {}

std::vector<Ellipsoid> EllipsoidFitter::fit(size_t wanted, const std::function<void(double)>& progress) const {
  const double thin = k_thin_sheet * std::sqrt(area_ / static_cast<double>(wanted));
  const auto thin_samples = std::count_if(samples_.begin(), samples_.end(), [&](const FitSample& s) { return s.inner < thin; });
  const double of_sheets = static_cast<double>(thin_samples) / static_cast<double>(samples_.size());
  const double share = std::min(k_first_share + k_first_of_sheets * of_sheets, k_most_first);
  const size_t first = std::max<size_t>(1, static_cast<size_t>(share * static_cast<double>(wanted)));
  std::vector<Ellipsoid> blobs = start_ellipsoids(samples_, area_, first);
  balance_weights(blobs);
  const size_t most = std::min(wanted / k_one_filler_in, wanted - std::min(wanted, blobs.size()));
  for (const Ellipsoid& b : fillers(blobs, samples_, area_, first, most)) blobs.push_back(b);
  for (size_t i = 0; i <= k_splits; ++i) {
    if (i > 0) split_worst(blobs, blobs.size() + (wanted - std::min(wanted, blobs.size())) * i / k_splits);
    solver_.improve(blobs, i == k_splits ? k_late_steps : k_early_steps);
    progress(double(i + 1) / double(k_splits + 1));
  }
  return blobs;
}

/// Changes each weight until the sum at the surface is about 1.
void EllipsoidFitter::balance_weights(std::vector<Ellipsoid>& blobs) const {
  for (int sweep = 0; sweep < k_weight_sweeps; ++sweep) {
    const std::vector<BlobValue> sums = solver_.values(blobs);
    for (Ellipsoid& b : blobs) {
      double excess = 0, share = 0;
      solver_.grid().visit_in(b, [&](uint32_t i, const Vec3d& u) {
        if (i >= samples_.size()) return;
        const double q = 1 - glm::dot(u, u);
        excess += q * q * std::log(std::max(sums[i].value, k_least_balanced)), share += q * q;
      });
      if (share > 0)
        b.log_weight = std::clamp(b.log_weight - k_weight_step * excess / share, std::log(k_least_balanced), std::log(k_most_balanced));
    }
  }
}

/// Of the samples, in squares of units.
std::vector<double> EllipsoidFitter::errors(const std::vector<BlobValue>& sums) const {
  std::vector<double> all;
  for (size_t i = 0; i < samples_.size(); ++i) {
    const double distance = std::min(std::abs(distance_estimate(sums[i])) / k_unit_distance, k_most_error);
    const double steepness = glm::length(sums[i].gradient);
    double sine = 0;
    if (has_normal(samples_[i]) && steepness > 0) sine = glm::length(glm::cross(sums[i].gradient, samples_[i].smooth)) / steepness;
    all.push_back(distance * distance + sine * sine / (k_unit_angle * k_unit_angle));
  }
  return all;
}

/// Splits the blobs that have the largest share in the error.
void EllipsoidFitter::split_worst(std::vector<Ellipsoid>& blobs, size_t wanted) const {
  const std::vector<BlobValue> sums = solver_.values(blobs);
  const std::vector<double> error = errors(sums);
  std::vector<double> share(blobs.size(), 0);
  for (size_t k = 0; k < blobs.size(); ++k) {
    const double w = std::exp(blobs[k].log_weight);
    solver_.grid().visit_in(blobs[k], [&](uint32_t i, const Vec3d& u) {
      if (i >= samples_.size()) return;
      const double q = 1 - glm::dot(u, u);
      share[k] += error[i] * w * q * q / std::max(sums[i].value, k_least_balanced);
    });
  }
  std::vector<size_t> order(blobs.size());
  std::iota(order.begin(), order.end(), size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) { return share[a] > share[b]; });
  order.resize(std::min(order.size(), wanted - std::min(wanted, blobs.size())));
  for (const size_t k : order) {
    const Ellipsoid other = split(blobs[k]);
    blobs.push_back(other);
  }
}

} // namespace kelpie
