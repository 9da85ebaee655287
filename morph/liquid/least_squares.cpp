#include "morph/liquid/least_squares.h"

#include <algorithm>
#include <cmath>

#include <ceres/ceres.h>

namespace kelpie {

namespace {

/// The distance that counts as one unit of error.
constexpr double k_unit = 0.002;

/// A hinge's slope is that of a distance error of so much per unit of f: it pushes as hard as
/// the surface does, on thin sheets too, where depths are small.
constexpr double k_outside_depth = 0.03, k_inside_depth = 0.04;

/// Outside f must stay below, inside above: a margin, so that nothing flickers across 1 in a morph.
constexpr double k_outside_level = 0.7, k_inside_level = 1.3;

/// How far a blob may stray from its sphere before that costs one unit of error: a share of its radius, factors
/// of radius and weight. It holds what the samples leave undetermined.
constexpr double k_prior = 0.3, k_prior_place = 0.5, k_prior_log_radius = 0.4, k_prior_log_weight = 0.7;

/// Hard limits: an LM step that overshoots must not throw a blob away for good.
constexpr double k_least_radius = 0.008, k_most_growth = 2, k_least_weight = 0.05, k_most_weight = 16;

constexpr int k_iterations = 5, k_linear_iterations = 60;

/// One constraint on the blobs that can reach it: scale (f - level), where sign is not 0 only on that side.
class ConstraintCost : public ceres::CostFunction {
public:
  ConstraintCost(const Vec3d& p, size_t blobs, double scale, double level, int sign) : p_(p), scale_(scale), level_(level), sign_(sign) {
    mutable_parameter_block_sizes()->assign(blobs, 5);
    set_num_residuals(1);
  }

  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
    const size_t n = parameter_block_sizes().size();
    double sum = -level_;
    for (size_t i = 0; i < n; ++i) sum += value(parameters[i]);
    const bool is_idle = sign_ != 0 && sum * sign_ <= 0;
    residuals[0] = is_idle ? 0 : sum * scale_;
    if (!jacobians) return true;
    for (size_t i = 0; i < n; ++i)
      if (jacobians[i]) differentiate(parameters[i], is_idle ? 0 : scale_, jacobians[i]);
    return true;
  }

private:
  double value(const double* b) const {
    const Vec3d d = p_ - Vec3d(b[0], b[1], b[2]);
    const double q = std::max(0.0, 1 - glm::dot(d, d) * std::exp(-2 * b[3]));
    return q > 0 ? std::exp(b[4]) * q * q : 0;
  }

  /// Of scale W q^2: dc = 4 W q (p - c)/R^2, d log R = 4 W q u, d log W = W q^2, u = 1 - q.
  void differentiate(const double* b, double scale, double* j) const {
    const Vec3d d = p_ - Vec3d(b[0], b[1], b[2]);
    const double inverse = std::exp(-2 * b[3]), u = glm::dot(d, d) * inverse, q = std::max(0.0, 1 - u),
                 w = q > 0 ? scale * std::exp(b[4]) : 0;
    const double slope = 4 * w * q * inverse;
    j[0] = slope * d.x, j[1] = slope * d.y, j[2] = slope * d.z;
    j[3] = 4 * w * q * u;
    j[4] = w * q * q;
  }

  Vec3d p_;
  double scale_, level_;
  int sign_;
};

class PriorCost : public ceres::SizedCostFunction<5, 5> {
public:
  explicit PriorCost(const BlobParameters& start) : start_(start) {
    const double place = k_prior_place * std::exp(start[3]);
    scale_ = {k_prior / place, k_prior / place, k_prior / place, k_prior / k_prior_log_radius, k_prior / k_prior_log_weight};
  }
  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
    for (int k = 0; k < 5; ++k) residuals[k] = scale_[k] * (parameters[0][k] - start_[k]);
    if (jacobians && jacobians[0])
      for (int k = 0; k < 25; ++k) jacobians[0][k] = k % 6 == 0 ? scale_[k / 6] : 0;
    return true;
  }

private:
  BlobParameters start_, scale_;
};

void add_blob(ceres::Problem& problem, FitBlob& b) {
  double* parameters = b.now.data();
  problem.AddResidualBlock(new PriorCost(b.start), nullptr, parameters);
  const double limits[2][2] = {{std::min(std::log(k_least_radius), b.start[3]), b.start[3] + std::log(k_most_growth)},
                               {std::log(k_least_weight), std::log(k_most_weight)}};
  for (int k = 0; k < 2; ++k) {
    parameters[3 + k] = std::clamp(parameters[3 + k], limits[k][0], limits[k][1]);
    problem.SetParameterLowerBound(parameters, 3 + k, limits[k][0]);
    problem.SetParameterUpperBound(parameters, 3 + k, limits[k][1]);
  }
}

void add_constraint(ceres::Problem& problem, std::vector<FitBlob>& blobs, const Constraint& c) {
  std::vector<double*> near;
  BlobValue f;
  for (FitBlob& b : blobs) {
    const Vec3d d = c.position - centre_of(b.now);
    const double reach = 1.1 * std::exp(b.now[3]); // a blob may grow into reach within a round
    if (glm::dot(d, d) > reach * reach) continue;
    near.push_back(b.now.data());
    const BlobValue v = evaluate(b.now, c.position);
    f.value += v.value, f.gradient += v.gradient;
  }
  if (near.empty()) return;
  double scale = 0, level = 1;
  int sign = 0;
  switch (c.kind) {
  case Constraint::Kind::surface: scale = std::abs(distance_estimate({2, f.gradient})); break;
  case Constraint::Kind::outside: scale = k_outside_depth, level = k_outside_level, sign = 1; break;
  case Constraint::Kind::inside: scale = k_inside_depth, level = k_inside_level, sign = -1; break;
  }
  problem.AddResidualBlock(new ConstraintCost(c.position, near.size(), scale / k_unit, level, sign), nullptr, near);
}

} // namespace

BlobValue evaluate(const BlobParameters& b, const Vec3d& p) {
  const Vec3d d = p - centre_of(b);
  const double inverse = std::exp(-2 * b[3]), q = 1 - glm::dot(d, d) * inverse;
  if (q <= 0) return {};
  const double w = std::exp(b[4]);
  return {w * q * q, -4 * w * q * inverse * d};
}

BlobValue evaluate(const std::vector<BlobParameters>& blobs, const Vec3d& p) {
  BlobValue sum;
  for (const BlobParameters& b : blobs) {
    const BlobValue v = evaluate(b, p);
    sum.value += v.value, sum.gradient += v.gradient;
  }
  return sum;
}

void improve_blobs(std::vector<FitBlob>& blobs, const std::vector<Constraint>& constraints) {
  ceres::Problem problem;
  for (FitBlob& b : blobs) add_blob(problem, b);
  for (const Constraint& c : constraints) add_constraint(problem, blobs, c);
  ceres::Solver::Options options;
  options.num_threads = 1;
  options.max_num_iterations = k_iterations;
  options.linear_solver_type = ceres::CGNR; // five times faster here than sparse Cholesky, for the same result
  options.max_linear_solver_iterations = k_linear_iterations;
  options.eta = 0.05;
  options.initial_trust_region_radius = 10; // cautious: the problem is only locally linear
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
}

} // namespace kelpie
