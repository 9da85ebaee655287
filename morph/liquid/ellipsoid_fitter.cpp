#include "morph/liquid/ellipsoid_fitter.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <numeric>

#include <Eigen/Eigenvalues>

#include "morph/liquid/ellipsoid_start.h"

namespace kelpie {

double knob(const char* name, double usual);

namespace {

constexpr double k_outside_distance = 0.02;

std::pair<Vec3d, Vec3d> across(const Vec3d& n) {
  const Vec3d other = std::abs(n.x) < 0.6 ? Vec3d(1, 0, 0) : Vec3d(0, 1, 0);
  const Vec3d a = glm::normalize(glm::cross(n, other));
  return {a, glm::cross(n, a)};
}

EllipsoidSolver make_solver(const std::vector<FitSample>& samples) {
  std::vector<Vec3d> places;
  std::vector<Probe> probes;
  const auto add = [&](const Vec3d& p, Probe probe) { places.push_back(p), probes.push_back(probe); };
  for (const FitSample& s : samples) {
    const auto [a, b] = across(s.smooth);
    add(s.position, {has_normal(s) ? Probe::Kind::normal : Probe::Kind::surface, {a, b, s.smooth}});
  }
  for (size_t i = 0; i < samples.size(); ++i) {
    const FitSample& s = samples[i];
    const double out = std::min(i % 2 ? k_outside_distance : 2 * k_outside_distance, s.outer);
    if (out > 0.25 * k_outside_distance) add(s.position + out * s.normal, {Probe::Kind::outside, {}});
    const double in = i % 2 ? s.inner : std::min(0.4 * s.inner, k_outside_distance);
    add(s.position - in * s.normal, {Probe::Kind::inside, {}});
  }
  return EllipsoidSolver(std::move(places), std::move(probes));
}

double cpu_now() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return double(t.tv_sec) + 1e-9 * double(t.tv_nsec);
}

} // namespace

EllipsoidFitter::EllipsoidFitter(std::vector<FitSample> samples, double area)
    : samples_(std::move(samples)), area_(area), solver_(make_solver(samples_)) {}

void EllipsoidFitter::report(const char* what, const std::vector<Ellipsoid>& blobs) const {
  const std::vector<BlobValue> sums = solver_.values(blobs);
  double d2 = 0, a2 = 0;
  size_t n = 0, hollow = 0, inside = 0, empty = 0, pairs = 0;
  for (const Ellipsoid& b : blobs) solver_.grid().visit_in(b, [&](uint32_t i, const Vec3d&) { pairs += i < samples_.size(); });
  for (size_t i = 0; i < sums.size(); ++i) {
    if (i < samples_.size()) {
      const double d = distance_estimate(sums[i]);
      d2 += d * d;
      if (glm::length(sums[i].gradient) == 0) { ++empty; continue; }
      if (!has_normal(samples_[i])) continue;
      const double a = std::acos(std::clamp(-glm::dot(glm::normalize(sums[i].gradient), samples_[i].smooth), -1.0, 1.0));
      a2 += a * a, ++n;
    } else if (solver_.probes()[i].kind == Probe::Kind::inside) ++inside, hollow += sums[i].value < 1;
  }
  std::fprintf(stderr, "%-10s %5zu blobs dist %.5f normals %.2f hollow %zu/%zu empty %zu overlap %.1f cpu %.2f\n", what, blobs.size(), std::sqrt(d2 / samples_.size()),
               57.29578 * std::sqrt(a2 / n), hollow, inside, empty, double(pairs) / samples_.size(), cpu_now());
}

void EllipsoidFitter::balance_weights(std::vector<Ellipsoid>& blobs) const {
  for (int sweep = 0; sweep < 8; ++sweep) {
    const std::vector<BlobValue> sums = solver_.values(blobs);
    for (Ellipsoid& b : blobs) {
      double excess = 0, share = 0;
      solver_.grid().visit_in(b, [&](uint32_t i, const Vec3d& u) {
        if (i >= samples_.size()) return;
        const double q = 1 - glm::dot(u, u), v = q * q;
        excess += v * std::log(std::max(sums[i].value, 0.1)), share += v;
      });
      if (share > 0) b.log_weight = std::clamp(b.log_weight - 0.7 * excess / share, std::log(0.1), std::log(10.0));
    }
  }
}

void EllipsoidFitter::split_worst(std::vector<Ellipsoid>& blobs, size_t wanted) const {
  if (wanted <= blobs.size()) return;
  const std::vector<BlobValue> sums = solver_.values(blobs);
  std::vector<double> error(samples_.size());
  for (size_t i = 0; i < samples_.size(); ++i) {
    const double d = std::min(std::abs(distance_estimate(sums[i])) / k_unit_distance, 10.0);
    double a = 0;
    if (has_normal(samples_[i]) && glm::length(sums[i].gradient) > 0)
      a = glm::length(glm::cross(glm::normalize(sums[i].gradient), samples_[i].smooth)) / k_unit_angle;
    error[i] = d * d + a * a;
  }
  std::vector<double> of_blob(blobs.size(), 0);
  for (size_t k = 0; k < blobs.size(); ++k) {
    const double w = std::exp(blobs[k].log_weight);
    solver_.grid().visit_in(blobs[k], [&](uint32_t i, const Vec3d& u) {
      if (i >= samples_.size()) return;
      const double q = 1 - glm::dot(u, u);
      of_blob[k] += error[i] * w * q * q / std::max(sums[i].value, 0.1);
    });
  }
  std::vector<size_t> order(blobs.size());
  std::iota(order.begin(), order.end(), size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) { return of_blob[a] > of_blob[b]; });
  const size_t many = std::min(wanted - blobs.size(), blobs.size());
  for (size_t r = 0; r < many; ++r) {
    Ellipsoid& b = blobs[order[r]];
    Eigen::Matrix3d m;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) m(i, j) = b.to_ball[j][i];
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(m); // ascending: the first is the longest
    const Eigen::Vector3d e = solver.eigenvectors().col(0);
    const double half = 1 / solver.eigenvalues()[0];
    static const double shrink = knob("SHRINK", 0.8), shift = knob("SHIFT", 0.27);
    const Eigen::Matrix3d narrower = m + (1 / shrink - 1) / half * e * e.transpose();
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) b.to_ball[j][i] = narrower(i, j);
    Ellipsoid other = b;
    const Vec3d away = shift * half * Vec3d(e[0], e[1], e[2]);
    static const double weigh = knob("WEIGH", 0.62);
    b.log_weight += std::log(weigh), other.log_weight = b.log_weight;
    b.centre += away, other.centre -= away;
    blobs.push_back(other);
  }
}

std::vector<Ellipsoid> EllipsoidFitter::fit(size_t wanted, const std::function<void(double)>& progress) const {
  const auto first = static_cast<size_t>(knob("FIRST", 0.85) * double(wanted));
  report("samples", {});
  std::vector<Ellipsoid> blobs = start_ellipsoids(samples_, area_, first);
  report("clusters", blobs);
  balance_weights(blobs);
  report("balanced", blobs);
  const std::vector<Ellipsoid> more = fillers(blobs, samples_, knob("FILLMIN", 0.7) * std::sqrt(area_ / double(first)), wanted / 4);
  blobs.insert(blobs.end(), more.begin(), more.end());
  report("filled", blobs);
  const int splits = int(knob("SPLITS", 2));
  solver_.improve(blobs, int(knob("STEPS0", 4)));
  report("improved", blobs);
  for (int s = 1; s <= splits; ++s) {
    split_worst(blobs, blobs.size() + (wanted - std::min(wanted, blobs.size())) * size_t(s) / size_t(splits));
    report("split", blobs);
    solver_.improve(blobs, int(s == splits ? knob("STEPS", 8) : knob("STEPS0", 4)));
    report("improved", blobs);
    progress(double(s) / splits);
  }
  return blobs;
}

} // namespace kelpie
