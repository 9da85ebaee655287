#include "morph/liquid/ellipsoid_solver.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include <Eigen/Dense>

namespace kelpie {

namespace {

/// A hinge's slope is that of a distance error of so much per unit of f.
constexpr double k_outside_depth = 0.015, k_inside_depth = 0.02;

/// Outside f must stay below, inside above: a margin, so that nothing flickers across 1 in a morph.
constexpr double k_outside_level = 0.7, k_inside_level = 1.3;

/// How far a blob may go in one step before that costs one unit of error: shares of its half axes, a factor of its weight.
constexpr double k_step_place = 0.3, k_step_stretch = 0.3, k_step_weight = 0.5;

constexpr double k_first_damping = 1, k_least_damping = 0.02, k_most_damping = 1e4;
constexpr int k_linear_iterations = 25;
constexpr double k_linear_goal = 0.05;

constexpr double k_least_weight = 0.05, k_most_weight = 16;

/// Half axes: the least, the most, and how many times the shortest the others may be.
double knob_(const char* name, double usual) {
  const char* s = std::getenv(name);
  return s ? std::atof(s) : usual;
}
const double k_least_half_axis = knob_("LEAST", 0.0015), k_most_half_axis = 0.6, k_most_aspect = knob_("ASPECT", 30);

/// A blob's unknowns: place (3, in its unit ball), increment of the map (6: xx yy zz xy xz yz), log W; two for padding.
constexpr int k_unknowns = 10, k_padded = 12;
using Row = std::array<float, k_padded>;

/// The rows of one probe and one blob: value, and the gradient along both tangents.
void differentiate(const Ellipsoid& b, const Vec3d& u, double value_scale, const Vec3d* tangents, double slope_scale, int rows, Row* out) {
  const double q = 1 - glm::dot(u, u), w = std::exp(b.log_weight), c = -4 * w * q * value_scale;
  const double value[k_padded] = {-c * u.x,         -c * u.y,         -c * u.z,         c * u.x * u.x, c * u.y * u.y, c * u.z * u.z,
                                  2 * c * u.x * u.y, 2 * c * u.x * u.z, 2 * c * u.y * u.z, w * q * q * value_scale};
  for (int k = 0; k < k_padded; ++k) out[0][k] = static_cast<float>(value[k]);
  for (int t = 0; t + 1 < rows; ++t) {
    const Vec3d s = b.to_ball * tangents[t];
    const double m = -4 * w * slope_scale, su = glm::dot(s, u), a = -2 * m * su, e = 2 * m * q;
    const Vec3d place = -a * u - m * q * s;
    const double slope[k_padded] = {place.x,
                                    place.y,
                                    place.z,
                                    a * u.x * u.x + e * s.x * u.x,
                                    a * u.y * u.y + e * s.y * u.y,
                                    a * u.z * u.z + e * s.z * u.z,
                                    2 * a * u.x * u.y + e * (s.x * u.y + s.y * u.x),
                                    2 * a * u.x * u.z + e * (s.x * u.z + s.z * u.x),
                                    2 * a * u.y * u.z + e * (s.y * u.z + s.z * u.y),
                                    m * q * su};
    for (int k = 0; k < k_padded; ++k) out[t + 1][k] = static_cast<float>(slope[k]);
  }
}

/// The Jacobian: for each probe the blobs that reach it, with up to three rows of each.
struct Jacobian {
  struct Entry {
    uint32_t blob, row; ///< the first of its rows in `rows`
  };
  std::vector<uint32_t> first;   ///< into the entries, for each probe; and their count
  std::vector<uint32_t> residual; ///< the first of each probe's residuals; and their count
  std::vector<Entry> entries;
  std::vector<Row> rows;
  std::vector<float> residuals;

  int rows_of(size_t probe) const { return static_cast<int>(residual[probe + 1] - residual[probe]); }

  /// out = J x
  void times(const std::vector<float>& x, std::vector<float>& out) const {
    for (size_t p = 0; p + 1 < first.size(); ++p) {
      const int n = rows_of(p);
      for (int r = 0; r < n; ++r) out[residual[p] + r] = 0;
      for (uint32_t e = first[p]; e < first[p + 1]; ++e) {
        const float* xs = x.data() + k_padded * entries[e].blob;
        for (int r = 0; r < n; ++r) {
          const Row& row = rows[entries[e].row + r];
          float sum[4] = {0, 0, 0, 0};
          for (int k = 0; k < k_padded; k += 4)
            for (int l = 0; l < 4; ++l) sum[l] += row[k + l] * xs[k + l];
          out[residual[p] + r] += (sum[0] + sum[1]) + (sum[2] + sum[3]);
        }
      }
    }
  }

  /// out = J^T y
  void transposed_times(const std::vector<float>& y, std::vector<float>& out) const {
    std::fill(out.begin(), out.end(), 0.f);
    for (size_t p = 0; p + 1 < first.size(); ++p) {
      const int n = rows_of(p);
      for (uint32_t e = first[p]; e < first[p + 1]; ++e) {
        float* to = out.data() + k_padded * entries[e].blob;
        for (int r = 0; r < n; ++r) {
          const Row& row = rows[entries[e].row + r];
          const float by = y[residual[p] + r];
          for (int k = 0; k < k_padded; ++k) to[k] += by * row[k];
        }
      }
    }
  }
};

using Block = Eigen::Matrix<float, k_unknowns, k_unknowns>;

double dot(const std::vector<float>& a, const std::vector<float>& b) {
  double sum = 0;
  for (size_t i = 0; i < a.size(); ++i) sum += double(a[i]) * b[i];
  return sum;
}

/// The damped normal equations, by conjugate gradients.
class NormalEquations {
public:
  NormalEquations(const Jacobian& j, size_t blobs) : j_(j), blobs_(blobs), diagonal_(blobs, Block::Zero()) {
    for (size_t p = 0; p + 1 < j.first.size(); ++p)
      for (uint32_t e = j.first[p]; e < j.first[p + 1]; ++e) {
        Block& block = diagonal_[j.entries[e].blob];
        for (int r = 0; r < j.rows_of(p); ++r) {
          const Row& row = j.rows[j.entries[e].row + r];
          for (int a = 0; a < k_unknowns; ++a)
            for (int b = 0; b < k_unknowns; ++b) block(a, b) += row[a] * row[b];
        }
      }
    gradient_.resize(k_padded * blobs);
    j.transposed_times(j.residuals, gradient_);
  }

  /// The step that minimises |J x + r|^2 + damping |x / step|^2.
  std::vector<float> solve(double damping) const {
    float stiffness[k_padded] = {};
    for (int k = 0; k < k_unknowns; ++k) {
      const double step = k < 3 ? k_step_place : k < 9 ? k_step_stretch : k_step_weight;
      stiffness[k] = static_cast<float>(damping / (step * step));
    }
    std::vector<Eigen::LLT<Block>> inverse(blobs_);
    for (size_t b = 0; b < blobs_; ++b) {
      Block block = diagonal_[b];
      for (int k = 0; k < k_unknowns; ++k) block(k, k) += stiffness[k];
      inverse[b].compute(block);
    }
    std::vector<float> x(k_padded * blobs_, 0.f), r(x.size()), z(x.size(), 0.f), p, ap(x.size()), jp(j_.residuals.size());
    for (size_t i = 0; i < r.size(); ++i) r[i] = -gradient_[i];
    const auto precondition = [&] {
      for (size_t b = 0; b < blobs_; ++b) {
        Eigen::Map<Eigen::Matrix<float, k_unknowns, 1>> to(z.data() + k_padded * b), from(r.data() + k_padded * b);
        to = inverse[b].solve(from);
      }
    };
    precondition();
    p = z;
    double rz = dot(r, z);
    const double goal = rz * k_linear_goal * k_linear_goal;
    for (int i = 0; i < k_linear_iterations && rz > goal && rz > 0; ++i) {
      j_.times(p, jp);
      j_.transposed_times(jp, ap);
      for (size_t k = 0; k < ap.size(); ++k) ap[k] += stiffness[k % k_padded] * p[k];
      const double alpha = rz / dot(p, ap);
      for (size_t k = 0; k < x.size(); ++k) x[k] += static_cast<float>(alpha) * p[k], r[k] -= static_cast<float>(alpha) * ap[k];
      precondition();
      const double next = dot(r, z), beta = next / rz;
      rz = next;
      for (size_t k = 0; k < p.size(); ++k) p[k] = z[k] + static_cast<float>(beta) * p[k];
    }
    return x;
  }

private:
  const Jacobian& j_;
  size_t blobs_;
  std::vector<Block> diagonal_;
  std::vector<float> gradient_;
};

/// Keeps half axes within their limits; the map becomes symmetric.
void regularise(Ellipsoid& b) {
  Eigen::Matrix3d m;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) m(i, j) = b.to_ball[j][i];
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(m.transpose() * m);
  Eigen::Vector3d half = solver.eigenvalues().cwiseMax(1e-12).cwiseSqrt().cwiseInverse(); // descending
  half = half.cwiseMin(k_most_half_axis).cwiseMax(k_least_half_axis);
  half[2] = std::max(half[2], half[0] / k_most_aspect);
  half[1] = std::max(half[1], half[2]);
  const Eigen::Matrix3d root = solver.eigenvectors() * half.cwiseInverse().asDiagonal() * solver.eigenvectors().transpose();
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) b.to_ball[j][i] = root(i, j);
}

/// The blob after a step, which is cut back where it is wide.
Ellipsoid stepped(Ellipsoid b, const float* x) {
  double most = 0;
  for (int k = 0; k < k_unknowns; ++k) most = std::max(most, std::abs(double(x[k])) / (k < 3 ? 0.5 : k < 9 ? 0.35 : 0.8));
  const double by = most > 1 ? 1 / most : 1;
  const Vec3d shift = by * Vec3d(x[0], x[1], x[2]);
  b.centre += glm::inverse(b.to_ball) * shift;
  const Mat3d increment(1 + by * x[3], by * x[6], by * x[7], by * x[6], 1 + by * x[4], by * x[8], by * x[7], by * x[8], 1 + by * x[5]);
  b.to_ball = increment * b.to_ball;
  b.log_weight = std::clamp(b.log_weight + by * x[9], std::log(k_least_weight), std::log(k_most_weight));
  regularise(b);
  return b;
}

bool is_surface(const Probe& p) { return p.kind == Probe::Kind::surface || p.kind == Probe::Kind::normal; }

} // namespace

double distance_estimate(const BlobValue& f) { return (f.value - 1) / std::max(glm::length(f.gradient), 10.0); }

/// What makes the sum's excess a distance, and its slope a sine: frozen for a step.
struct EllipsoidSolver::Scales {
  std::vector<double> value, slope, level;
  std::vector<int8_t> side; ///< 0: both count, 1: only an excess, -1: only a lack
  std::vector<char> is_turned; ///< where the gradient looks inward: then its component along the normal counts as well
};

int EllipsoidSolver::rows_of(const Scales& s, size_t i) const { return s.slope[i] > 0 ? s.is_turned[i] ? 4 : 3 : 1; }

/// Across the normal the slope should be 0; along it, where it is turned, that of the field outward from a surface: 1 / k_unit_angle.
double EllipsoidSolver::slope_error(const Scales& s, size_t i, int axis, const Vec3d& gradient) const {
  const double slope = glm::dot(probes_[i].axes[size_t(axis)], gradient) * s.slope[i];
  return axis < 2 ? slope : slope + 0.5 / k_unit_angle;
}

EllipsoidSolver::EllipsoidSolver(std::vector<Vec3d> places, std::vector<Probe> probes)
    : places_(std::move(places)), probes_(std::move(probes)), grid_(places_) {}

std::vector<BlobValue> EllipsoidSolver::values(const std::vector<Ellipsoid>& blobs) const {
  std::vector<BlobValue> sums(places_.size());
  for (const Ellipsoid& b : blobs) {
    const double w = std::exp(b.log_weight);
    grid_.visit_in(b, [&](uint32_t i, const Vec3d& u) {
      const double q = 1 - glm::dot(u, u);
      sums[i].value += w * q * q;
      if (is_surface(probes_[i])) sums[i].gradient -= 4 * w * q * (u * b.to_ball);
    });
  }
  return sums;
}

EllipsoidSolver::Scales EllipsoidSolver::scales(const std::vector<BlobValue>& sums) const {
  Scales s;
  for (size_t i = 0; i < sums.size(); ++i) {
    const double steepness = std::max(glm::length(sums[i].gradient), 10.0);
    double value = 1 / (steepness * k_unit_distance), slope = 0, level = 1;
    int8_t side = 0;
    switch (probes_[i].kind) {
    case Probe::Kind::surface: break;
    case Probe::Kind::normal: slope = 1 / (steepness * k_unit_angle); break;
    case Probe::Kind::outside: value = k_outside_depth / k_unit_distance, level = k_outside_level, side = 1; break;
    case Probe::Kind::inside: value = k_inside_depth / k_unit_distance, level = k_inside_level, side = -1; break;
    }
    s.value.push_back(value), s.slope.push_back(slope), s.level.push_back(level), s.side.push_back(side);
    s.is_turned.push_back(slope > 0 && glm::dot(sums[i].gradient, probes_[i].axes[2]) > -0.3 * steepness);
  }
  return s;
}

double EllipsoidSolver::cost(const std::vector<BlobValue>& sums, const Scales& s) const {
  double cost = 0;
  for (size_t i = 0; i < sums.size(); ++i) {
    const double excess = sums[i].value - s.level[i];
    if (s.side[i] == 0 || excess * s.side[i] > 0) cost += excess * excess * s.value[i] * s.value[i];
    for (int t = 1; t < rows_of(s, i); ++t) {
      const double slope = slope_error(s, i, t - 1, sums[i].gradient);
      cost += slope * slope;
    }
  }
  return cost;
}

void EllipsoidSolver::improve(std::vector<Ellipsoid>& blobs, int steps) const {
  double damping = k_first_damping;
  std::vector<BlobValue> sums = values(blobs);
  for (int step = 0; step < steps; ++step) {
    const Scales scale = scales(sums);
    const double before = cost(sums, scale);
    Jacobian j;
    j.first.assign(places_.size() + 1, 0);
    j.residual.assign(places_.size() + 1, 0);
    std::vector<char> is_idle(places_.size(), 0);
    for (size_t i = 0; i < places_.size(); ++i) {
      is_idle[i] = scale.side[i] != 0 && (sums[i].value - scale.level[i]) * scale.side[i] <= 0;
      j.residual[i + 1] = j.residual[i] + static_cast<uint32_t>(is_idle[i] ? 0 : rows_of(scale, i));
    }
    for (const Ellipsoid& b : blobs)
      grid_.visit_in(b, [&](uint32_t i, const Vec3d&) { j.first[i + 1] += !is_idle[i]; });
    for (size_t i = 0; i < places_.size(); ++i) j.first[i + 1] += j.first[i];
    j.entries.resize(j.first.back());
    std::vector<uint32_t> next(j.first.begin(), j.first.end() - 1), first_row(places_.size());
    uint32_t rows = 0;
    for (size_t i = 0; i < places_.size(); ++i)
      first_row[i] = rows, rows += static_cast<uint32_t>(j.rows_of(i)) * (j.first[i + 1] - j.first[i]);
    j.rows.resize(rows);
    for (uint32_t b = 0; b < blobs.size(); ++b)
      grid_.visit_in(blobs[b], [&](uint32_t i, const Vec3d& u) {
        if (is_idle[i]) return;
        const int n = j.rows_of(i);
        const uint32_t row = first_row[i] + (next[i] - j.first[i]) * static_cast<uint32_t>(n);
        j.entries[next[i]++] = {b, row};
        differentiate(blobs[b], u, scale.value[i], probes_[i].axes.data(), scale.slope[i], n, &j.rows[row]);
      });
    j.residuals.resize(j.residual.back());
    for (size_t i = 0; i < places_.size(); ++i) {
      if (is_idle[i]) continue;
      float* r = &j.residuals[j.residual[i]];
      r[0] = static_cast<float>((sums[i].value - scale.level[i]) * scale.value[i]);
      for (int t = 1; t < rows_of(scale, i); ++t) r[t] = static_cast<float>(slope_error(scale, i, t - 1, sums[i].gradient));
    }
    const NormalEquations equations(j, blobs.size());
    bool is_better = false;
    while (!is_better && damping <= k_most_damping) {
      const std::vector<float> x = equations.solve(damping);
      std::vector<Ellipsoid> tried;
      for (size_t b = 0; b < blobs.size(); ++b) tried.push_back(stepped(blobs[b], &x[k_padded * b]));
      std::vector<BlobValue> then = values(tried);
      is_better = cost(then, scale) < before;
      if (is_better) blobs = std::move(tried), sums = std::move(then);
      damping = is_better ? std::max(damping * 0.3, k_least_damping) : damping * 5;
    }
    if (!is_better) return;
  }
}

} // namespace kelpie
