#include "morph/liquid/ellipsoid_solver.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Eigenvalues>

#include "morph/liquid/normal_equations.h"

namespace kelpie {

namespace {

/// Beside the surface a hinge's slope is that of a distance error of so much per unit of f. Outside f must stay below, inside above: a
/// margin, so that nothing flickers across 1 in a morph, and sheets are as steep as can be.
constexpr double k_depth_outside = 0.015, k_depth_inside = 0.02, k_level_outside = 0.7, k_level_inside = 1.3;

/// Where the gradient looks away from the normal, more or less, the slope across it says nothing: there the slope along it counts as well,
/// which should be `k_turned_goal` of what it is.
constexpr double k_turned = -0.3, k_turned_goal = 0.5;

/// How far a blob may go in one step before that costs one unit of error: shares of its half axes, a factor of its weight. And how
/// far at most.
constexpr double k_usual_move = 0.3, k_usual_stretch = 0.3, k_usual_log_weight = 0.5;
constexpr double k_most_move = 0.5, k_most_stretch = 0.35, k_most_log_weight = 0.8;
constexpr std::array<double, k_blob_unknowns> k_usual_steps{k_usual_move,    k_usual_move,      k_usual_move,    k_usual_stretch,
                                                            k_usual_stretch, k_usual_stretch,   k_usual_stretch, k_usual_stretch,
                                                            k_usual_stretch, k_usual_log_weight};

constexpr double k_damping_first = 1, k_damping_least = 0.02, k_damping_most = 1e4, k_damping_down = 0.3, k_damping_up = 5;

/// A step that gains less is the last.
constexpr double k_least_gain = 0.002;

/// Limits of weights and half axes; the longest may be so many times as long as the shortest.
constexpr double k_lightest = 0.05, k_heaviest = 16, k_least_half = 0.0015, k_most_half = 0.6, k_most_slender = 30;

bool is_of_surface(const Probe& p) { return p.kind == Probe::Kind::surface || p.kind == Probe::Kind::normal; }

/// The rows of a probe for one blob: the value and the slopes along axes, with u where in the blob's ball the probe is. Of f = W q^2, with
/// du = -place + stretch u: df = -4 W q u.du + f d log W; of the slope m q s.u, with m = -4 W, s = to_ball axis and ds = stretch s:
/// m (-2 u.du s.u + q (s.du + ds.u)).
void differentiate(const Ellipsoid& b, const Vec3d& u, double value_scale, const Vec3d* axes, double slope_scale, uint32_t rows,
                   JacobianRow* out) {
  const double q = 1 - glm::dot(u, u), w = std::exp(b.log_weight), c = -4 * w * q * value_scale;
  const auto set = [](JacobianRow& row, const Vec3d& place, const Vec3d& straight, const Vec3d& skew, double weight) {
    for (int k = 0; k < 3; ++k) {
      row[size_t(k)] = static_cast<float>(place[k]);
      row[size_t(3 + k)] = static_cast<float>(straight[k]);
      row[size_t(6 + k)] = static_cast<float>(skew[k]);
    }
    row[9] = static_cast<float>(weight), row[10] = row[11] = 0;
  };
  const Vec3d squares = u * u, products(u.x * u.y, u.x * u.z, u.y * u.z);
  set(out[0], -c * u, c * squares, 2 * c * products, w * q * q * value_scale);
  for (uint32_t r = 1; r < rows; ++r) {
    const Vec3d s = b.to_ball * axes[r - 1];
    const double m = -4 * w * slope_scale, su = glm::dot(s, u), a = -2 * m * su, e = 2 * m * q;
    const Vec3d mixed(s.x * u.y + s.y * u.x, s.x * u.z + s.z * u.x, s.y * u.z + s.z * u.y);
    set(out[r], -a * u - m * q * s, a * squares + e * s * u, 2 * a * products + e * mixed, m * q * su);
  }
}

/// Keeps half axes within their limits; the map becomes symmetric.
void regularise(Ellipsoid& b) {
  Eigen::Matrix3d m;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) m(i, j) = b.to_ball[j][i];
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(m.transpose() * m);
  Eigen::Vector3d half = solver.eigenvalues().cwiseMax(1e-12).cwiseSqrt().cwiseInverse(); // descending
  half = half.cwiseMin(k_most_half).cwiseMax(k_least_half);
  half = half.cwiseMax(half[0] / k_most_slender);
  const Eigen::Matrix3d root = solver.eigenvectors() * half.cwiseInverse().asDiagonal() * solver.eigenvectors().transpose();
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) b.to_ball[j][i] = root(i, j);
}

/// The blob after a step, which is cut back where it is wide.
Ellipsoid stepped(Ellipsoid b, const float* x) {
  double most = 1;
  for (int k = 0; k < k_blob_unknowns; ++k)
    most = std::max(most, std::abs(double(x[k])) / (k < 3 ? k_most_move : k < 9 ? k_most_stretch : k_most_log_weight));
  const double by = 1 / most;
  b.centre += glm::inverse(b.to_ball) * (by * Vec3d(x[0], x[1], x[2]));
  const Mat3d stretch{{1 + by * x[3], by * x[6], by * x[7]}, {by * x[6], 1 + by * x[4], by * x[8]}, {by * x[7], by * x[8], 1 + by * x[5]}};
  b.to_ball = stretch * b.to_ball;
  b.log_weight = std::clamp(b.log_weight + by * x[9], std::log(k_lightest), std::log(k_heaviest));
  regularise(b);
  return b;
}

} // namespace

/// What makes errors of the sum distances, and slopes sines: frozen for a step.
struct EllipsoidSolver::Scales {
  struct Scale {
    double value = 0, slope = 0, level = 1;
    int side = 0; ///< 0: both count, 1: only an excess, -1: only a lack
    uint32_t residuals = 1;
  };
  std::vector<Scale> of_probe;

  double value_error(size_t probe, double sum) const {
    const Scale& s = of_probe[probe];
    const double excess = sum - s.level;
    return s.side == 0 || excess * s.side > 0 ? excess * s.value : 0;
  }
};

struct EllipsoidSolver::Jacobian : BlobJacobian {};

EllipsoidSolver::EllipsoidSolver(std::vector<Vec3d> places, std::vector<Probe> probes)
    : places_(std::move(places)), probes_(std::move(probes)), grid_(places_) {}

std::vector<BlobValue> EllipsoidSolver::values(const std::vector<Ellipsoid>& blobs) const {
  std::vector<BlobValue> sums(places_.size());
  for (const Ellipsoid& b : blobs) {
    const double w = std::exp(b.log_weight);
    grid_.visit_in(b, [&](uint32_t i, const Vec3d& u) {
      if (is_of_surface(probes_[i])) {
        add_value(b, w, u, sums[i]);
      } else {
        const double q = 1 - glm::dot(u, u);
        sums[i].value += w * q * q;
      }
    });
  }
  return sums;
}

EllipsoidSolver::Scales EllipsoidSolver::scales(const std::vector<BlobValue>& sums) const {
  Scales all;
  for (size_t i = 0; i < sums.size(); ++i) {
    Scales::Scale s;
    const double steepness = std::max(glm::length(sums[i].gradient), k_least_steepness);
    switch (probes_[i].kind) {
    case Probe::Kind::normal:
      s.slope = 1 / (steepness * k_unit_angle);
      s.residuals = glm::dot(sums[i].gradient, probes_[i].axes[2]) > k_turned * steepness ? 4 : 3;
      [[fallthrough]];
    case Probe::Kind::surface: s.value = 1 / (steepness * k_unit_distance); break;
    case Probe::Kind::outside: s.value = k_depth_outside / k_unit_distance, s.level = k_level_outside, s.side = 1; break;
    case Probe::Kind::inside: s.value = k_depth_inside / k_unit_distance, s.level = k_level_inside, s.side = -1; break;
    }
    all.of_probe.push_back(s);
  }
  return all;
}

double EllipsoidSolver::slope_error(const Scales& s, size_t probe, int axis, const Vec3d& gradient) const {
  const double slope = glm::dot(probes_[probe].axes[size_t(axis)], gradient) * s.of_probe[probe].slope;
  return axis < 2 ? slope : slope + k_turned_goal / k_unit_angle;
}

double EllipsoidSolver::cost(const std::vector<BlobValue>& sums, const Scales& s) const {
  double cost = 0;
  for (size_t i = 0; i < sums.size(); ++i) {
    cost += std::pow(s.value_error(i, sums[i].value), 2);
    for (uint32_t r = 1; r < s.of_probe[i].residuals; ++r) cost += std::pow(slope_error(s, i, int(r) - 1, sums[i].gradient), 2);
  }
  return cost;
}

EllipsoidSolver::Jacobian EllipsoidSolver::jacobian(const std::vector<Ellipsoid>& blobs, const std::vector<BlobValue>& sums,
                                                    const Scales& s) const {
  Jacobian j;
  const size_t n = places_.size();
  j.first_entry.assign(n + 1, 0), j.first_residual.assign(n + 1, 0);
  for (size_t i = 0; i < n; ++i) {
    const double error = s.value_error(i, sums[i].value);
    const bool is_idle = s.of_probe[i].side != 0 && error == 0;
    j.first_residual[i + 1] = j.first_residual[i] + (is_idle ? 0 : s.of_probe[i].residuals);
    if (is_idle) continue;
    j.residuals.push_back(static_cast<float>(error));
    for (uint32_t r = 1; r < s.of_probe[i].residuals; ++r)
      j.residuals.push_back(static_cast<float>(slope_error(s, i, int(r) - 1, sums[i].gradient)));
  }
  for (const Ellipsoid& b : blobs) grid_.visit_in(b, [&](uint32_t i, const Vec3d&) { j.first_entry[i + 1] += j.residuals_of(i) > 0; });
  for (size_t i = 0; i < n; ++i) j.first_entry[i + 1] += j.first_entry[i];
  j.entries.resize(j.first_entry.back());
  std::vector<uint32_t> next(j.first_entry.begin(), j.first_entry.end() - 1), next_row(n);
  uint32_t rows = 0;
  for (size_t i = 0; i < n; ++i) next_row[i] = rows, rows += j.residuals_of(i) * (j.first_entry[i + 1] - j.first_entry[i]);
  j.rows.resize(rows);
  for (uint32_t b = 0; b < blobs.size(); ++b)
    grid_.visit_in(blobs[b], [&](uint32_t i, const Vec3d& u) {
      const uint32_t count = j.residuals_of(i);
      if (count == 0) return;
      j.entries[next[i]++] = {b, next_row[i]};
      differentiate(blobs[b], u, s.of_probe[i].value, probes_[i].axes.data(), s.of_probe[i].slope, count, &j.rows[next_row[i]]);
      next_row[i] += count;
    });
  return j;
}

void EllipsoidSolver::improve(std::vector<Ellipsoid>& blobs, int steps) const {
  double damping = k_damping_first;
  std::vector<BlobValue> sums = values(blobs);
  for (int step = 0; step < steps; ++step) {
    const Scales scale = scales(sums);
    const double before = cost(sums, scale);
    double after = before;
    const Jacobian j = jacobian(blobs, sums, scale);
    const NormalEquations equations(j, blobs.size());
    while (!(after < before)) {
      if (damping > k_damping_most) return;
      const std::vector<float> x = equations.solve(damping, k_usual_steps);
      std::vector<Ellipsoid> tried;
      for (size_t b = 0; b < blobs.size(); ++b) tried.push_back(stepped(blobs[b], &x[k_padded_unknowns * b]));
      std::vector<BlobValue> then = values(tried);
      after = cost(then, scale);
      if (after < before) blobs = std::move(tried), sums = std::move(then);
      damping = after < before ? std::max(damping * k_damping_down, k_damping_least) : damping * k_damping_up;
    }
    if (before - after < k_least_gain * before) return;
  }
}

} // namespace kelpie
