#include "morph/liquid/normal_equations.h"

#include <algorithm>

#include <Eigen/Cholesky>

namespace kelpie {

namespace {

constexpr int k_most_conjugate_steps = 25;

/// Enough less than at the beginning.
constexpr double k_conjugate_goal = 0.05;

using BlobBlock = Eigen::Matrix<float, k_blob_unknowns, k_blob_unknowns>;
using BlobVector = Eigen::Matrix<float, k_blob_unknowns, 1>;

double product(const std::vector<float>& a, const std::vector<float>& b) {
  double sum = 0;
  for (size_t i = 0; i < a.size(); ++i) sum += double(a[i]) * double(b[i]);
  return sum;
}

} // namespace

NormalEquations::NormalEquations(const BlobJacobian& j, size_t blobs) : j_(j), blobs_(blobs), squares_(blobs) {
  for (auto& block : squares_) block.fill(0);
  for (size_t p = 0; p + 1 < j.first_entry.size(); ++p)
    for (uint32_t e = j.first_entry[p]; e < j.first_entry[p + 1]; ++e) {
      float* block = squares_[j.entries[e].blob].data();
      for (uint32_t r = 0; r < j.residuals_of(p); ++r) {
        const JacobianRow& row = j.rows[j.entries[e].row + r];
        for (size_t a = 0; a < k_blob_unknowns; ++a)
          for (size_t b = 0; b < k_blob_unknowns; ++b) block[k_blob_unknowns * a + b] += row[a] * row[b];
      }
    }
  gradient_.resize(k_padded_unknowns * blobs);
  transposed_times(j.residuals, gradient_);
}

void NormalEquations::times(const std::vector<float>& x, std::vector<float>& out) const {
  for (size_t p = 0; p + 1 < j_.first_entry.size(); ++p) {
    float* to = out.data() + j_.first_residual[p];
    const uint32_t n = j_.residuals_of(p);
    std::fill(to, to + n, 0.f);
    for (uint32_t e = j_.first_entry[p]; e < j_.first_entry[p + 1]; ++e) {
      const float* from = x.data() + k_padded_unknowns * j_.entries[e].blob;
      for (uint32_t r = 0; r < n; ++r) {
        const float* row = j_.rows[j_.entries[e].row + r].data();
        float lanes[4] = {0, 0, 0, 0};
        for (int k = 0; k < k_padded_unknowns; k += 4)
          for (int l = 0; l < 4; ++l) lanes[l] += row[k + l] * from[k + l];
        to[r] += (lanes[0] + lanes[1]) + (lanes[2] + lanes[3]);
      }
    }
  }
}

void NormalEquations::transposed_times(const std::vector<float>& y, std::vector<float>& out) const {
  std::fill(out.begin(), out.end(), 0.f);
  for (size_t p = 0; p + 1 < j_.first_entry.size(); ++p) {
    const float* from = y.data() + j_.first_residual[p];
    for (uint32_t e = j_.first_entry[p]; e < j_.first_entry[p + 1]; ++e) {
      float* to = out.data() + k_padded_unknowns * j_.entries[e].blob;
      for (uint32_t r = 0; r < j_.residuals_of(p); ++r) {
        const float* row = j_.rows[j_.entries[e].row + r].data();
        for (int k = 0; k < k_padded_unknowns; ++k) to[k] += from[r] * row[k];
      }
    }
  }
}

std::vector<float> NormalEquations::solve(double damping, const std::array<double, k_blob_unknowns>& usual) const {
  std::array<float, k_padded_unknowns> stiffness{};
  for (size_t k = 0; k < k_blob_unknowns; ++k) stiffness[k] = static_cast<float>(damping / (usual[k] * usual[k]));
  std::vector<Eigen::LLT<BlobBlock>> inverse(blobs_);
  for (size_t b = 0; b < blobs_; ++b) {
    BlobBlock block = Eigen::Map<const BlobBlock>(squares_[b].data());
    for (int k = 0; k < k_blob_unknowns; ++k) block(k, k) += stiffness[size_t(k)];
    inverse[b].compute(block);
  }
  const size_t n = k_padded_unknowns * blobs_;
  std::vector<float> x(n, 0.f), rest(n), z(n, 0.f), along, changed(n), seen(j_.residuals.size());
  for (size_t i = 0; i < n; ++i) rest[i] = -gradient_[i];
  const auto precondition = [&] {
    for (size_t b = 0; b < blobs_; ++b)
      Eigen::Map<BlobVector>(z.data() + k_padded_unknowns * b) =
          inverse[b].solve(Eigen::Map<const BlobVector>(rest.data() + k_padded_unknowns * b));
  };
  precondition();
  along = z;
  double square = product(rest, z);
  const double goal = square * k_conjugate_goal * k_conjugate_goal;
  for (int i = 0; i < k_most_conjugate_steps && square > goal && square > 0; ++i) {
    times(along, seen);
    transposed_times(seen, changed);
    for (size_t k = 0; k < n; ++k) changed[k] += stiffness[k % k_padded_unknowns] * along[k];
    const auto step = static_cast<float>(square / product(along, changed));
    for (size_t k = 0; k < n; ++k) x[k] += step * along[k], rest[k] -= step * changed[k];
    precondition();
    const double next = product(rest, z);
    const auto kept = static_cast<float>(next / square);
    square = next;
    for (size_t k = 0; k < n; ++k) along[k] = z[k] + kept * along[k];
  }
  return x;
}

} // namespace kelpie
