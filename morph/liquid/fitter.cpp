#include "morph/liquid/fitter.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace kelpie {

namespace {

/// Rounds of the solver; blobs are relocated before the first few of them. More than these gain little.
constexpr int k_fit_rounds = 7, k_relocations = 2;

/// Good enough: a fifth of what one sees.
constexpr double k_rms_goal = 0.0004;

/// The share of the blobs that may be moved at once, the error from which a place deserves one, and its size there.
constexpr double k_relocated_share = 0.1, k_poor = 0.003, k_largest_new = 0.03;

/// Smaller spheres than this mark the mesh's edges and corners: as blobs they would do nothing.
constexpr double k_least_sphere = 0.008;

/// Distances outside the surface at which there must be no field.
constexpr double k_outside = 0.02;

/// The stiffness with which blobs begin.
constexpr double k_stiffness = 2;

constexpr int k_balance_sweeps = 12;
constexpr double k_balance_step = 0.7;

/// A blob whose own surface is the sphere.
BlobParameters blob_of_sphere(const MedialSphere& s) {
  const double e = std::max(s.radius, k_least_sphere);
  return {s.centre.x, s.centre.y, s.centre.z, std::log(e * std::sqrt(1 + 1 / k_stiffness)), 2 * std::log(1 + k_stiffness)};
}

std::vector<BlobParameters> parameters(const std::vector<FitBlob>& blobs) {
  std::vector<BlobParameters> all;
  for (const FitBlob& b : blobs) all.push_back(b.now);
  return all;
}

} // namespace

Fitter::Fitter(std::vector<SurfaceSample> samples, const TriangleTree& mesh)
    : samples_(std::move(samples)), poles_(find_poles(samples_, mesh)) {
  for (size_t i = 0; i < samples_.size(); ++i) add_constraints(i);
}

std::vector<BlobParameters> Fitter::fit(std::span<const MedialSphere> spheres, size_t wanted,
                                        const std::function<void(double)>& progress) const {
  std::vector<BlobParameters> first;
  for (const MedialSphere& s : spheres) first.push_back(blob_of_sphere(s));
  balance_weights(first);
  std::vector<FitBlob> blobs;
  for (const BlobParameters& b : first) blobs.push_back({b, b});
  for (int round = 0; round < k_fit_rounds; ++round) {
    if (round > 0 && round <= k_relocations) relocate(blobs, wanted);
    improve_blobs(blobs, constraints_);
    progress(double(round + 1) / k_fit_rounds);
    if (rms_estimate(parameters(blobs)) < k_rms_goal) break;
  }
  return parameters(blobs);
}

/// The poles' balls are free of surface, so points within them are known to be outside or inside without asking the mesh.
void Fitter::add_constraints(size_t i) {
  const SurfaceSample& s = samples_[i];
  constraints_.push_back({Constraint::Kind::surface, s.position});
  const double out = std::min(i % 2 ? k_outside : 2 * k_outside, poles_[i].outer.radius);
  if (out > 0.25 * k_outside) constraints_.push_back({Constraint::Kind::outside, s.position + out * s.normal});
  const double radius = poles_[i].inner.radius;
  if (!(radius > 0)) return;
  const double in = i % 2 ? radius : std::min(0.4 * radius, k_outside);
  constraints_.push_back({Constraint::Kind::inside, s.position - in * s.normal});
}

/// Spheres overlap, and their potentials add up to much more than 1: changes each weight until the sum at the
/// surface is about 1. (Gauss–Newton started above that throws blobs away.)
void Fitter::balance_weights(std::vector<BlobParameters>& blobs) const {
  for (int sweep = 0; sweep < k_balance_sweeps; ++sweep) {
    std::vector<double> excess(blobs.size(), 0), share(blobs.size(), 0), values(blobs.size());
    for (const SurfaceSample& s : samples_) {
      for (size_t i = 0; i < blobs.size(); ++i) values[i] = evaluate(blobs[i], s.position).value;
      const double here = std::log(std::max(std::accumulate(values.begin(), values.end(), 0.0), 0.1));
      for (size_t i = 0; i < blobs.size(); ++i) excess[i] += values[i] * here, share[i] += values[i];
    }
    for (size_t i = 0; i < blobs.size(); ++i)
      if (share[i] > 0) blobs[i][4] = std::clamp(blobs[i][4] - k_balance_step * excess[i] / share[i], std::log(0.1), std::log(10.0));
  }
}

/// Takes blobs that do least for the surface and puts them where it is worst.
void Fitter::relocate(std::vector<FitBlob>& blobs, size_t wanted) const {
  const std::vector<BlobParameters> now = parameters(blobs);
  const size_t missing = wanted - std::min(wanted, blobs.size());
  const std::vector<FitBlob> fresh =
      blobs_for_worst(now, std::max(missing, static_cast<size_t>(k_relocated_share * static_cast<double>(blobs.size()))));
  const size_t drop = fresh.size() - std::min(fresh.size(), missing);
  const std::vector<size_t> order = by_usefulness(now);
  std::vector<char> is_dropped(blobs.size(), 0);
  for (size_t i = 0; i < std::min(drop, order.size()); ++i) is_dropped[order[i]] = 1;
  size_t i = 0;
  blobs.erase(std::remove_if(blobs.begin(), blobs.end(), [&](const FitBlob&) { return is_dropped[i++] != 0; }), blobs.end());
  blobs.insert(blobs.end(), fresh.begin(), fresh.end());
}

/// From the blob that contributes least to the surface samples on.
std::vector<size_t> Fitter::by_usefulness(const std::vector<BlobParameters>& blobs) const {
  std::vector<double> use(blobs.size(), 0);
  for (const SurfaceSample& s : samples_)
    for (size_t i = 0; i < blobs.size(); ++i) use[i] += evaluate(blobs[i], s.position).value;
  std::vector<size_t> order(blobs.size());
  std::iota(order.begin(), order.end(), size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) { return use[a] < use[b]; });
  return order;
}

/// New blobs just below the samples with the largest errors, apart from each other.
std::vector<FitBlob> Fitter::blobs_for_worst(const std::vector<BlobParameters>& blobs, size_t most) const {
  std::vector<std::pair<double, size_t>> errors;
  for (size_t k = 0; k < samples_.size(); ++k) errors.push_back({-std::abs(distance_estimate(evaluate(blobs, samples_[k].position))), k});
  std::sort(errors.begin(), errors.end());
  std::vector<FitBlob> fresh;
  for (const auto& [error, k] : errors) {
    if (fresh.size() >= most || -error < k_poor) break;
    const double radius = std::clamp(poles_[k].inner.radius, k_least_sphere, k_largest_new);
    const Vec3d centre = samples_[k].position - radius * samples_[k].normal;
    const auto is_near = [&](const FitBlob& b) { return glm::length(centre_of(b.now) - centre) < std::exp(b.now[3]); };
    if (std::any_of(fresh.begin(), fresh.end(), is_near)) continue;
    BlobParameters b = blob_of_sphere({centre, radius});
    b[4] = std::log(std::clamp(1.3 - evaluate(blobs, centre).value, 0.1, 2.0)); // what is missing there
    fresh.push_back({b, b});
  }
  return fresh;
}

double Fitter::rms_estimate(const std::vector<BlobParameters>& blobs) const {
  double squares = 0;
  for (const SurfaceSample& s : samples_) {
    const double d = distance_estimate(evaluate(blobs, s.position));
    squares += d * d;
  }
  return std::sqrt(squares / static_cast<double>(samples_.size()));
}

} // namespace kelpie
