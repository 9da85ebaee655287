#include "morph/liquid/local_balance.h"

#include <algorithm>
#include <cmath>

namespace kelpie {

namespace {

constexpr int k_factor_sweeps = 8;
/// The exponent of each step: less than 1, as a blob's neighbours are changed at the same time.
constexpr double k_step = 0.7;
/// Of one sweep, and of all.
constexpr double k_most_change = 3, k_most_taken = 20;

/// What the blobs near a place add to its sum, for a weight that is scaled by 1.
class Neighbours {
public:
  explicit Neighbours(const BlobCloud& cloud) : first_{0} {
    for (const Blob& at : cloud) {
      for (uint32_t j = 0; j < cloud.size(); ++j) {
        const Blob& b = cloud[j];
        const double u = squared_place(b, Vec3d(at.centre - b.centre));
        if (u < 1) entries_.push_back({j, b.weight * falloff(b.falloff, u)});
      }
      first_.push_back(entries_.size());
    }
  }

  double sum_at(size_t i, std::span<const double> factors) const {
    double sum = 0;
    for (size_t k = first_[i]; k < first_[i + 1]; ++k) sum += factors[entries_[k].blob] * entries_[k].potential;
    return sum;
  }

private:
  struct Entry {
    uint32_t blob;
    double potential;
  };
  std::vector<Entry> entries_;
  std::vector<size_t> first_; ///< into the entries, for each blob; and their count
};

} // namespace

std::vector<double> potentials_at_centres(const BlobCloud& cloud) {
  const Neighbours neighbours(cloud);
  const std::vector<double> ones(cloud.size(), 1);
  std::vector<double> sums;
  for (size_t i = 0; i < cloud.size(); ++i) sums.push_back(neighbours.sum_at(i, ones));
  return sums;
}

std::vector<double> balancing_factors(const BlobCloud& cloud, std::span<const double> wanted) {
  const Neighbours neighbours(cloud);
  std::vector<double> factors(cloud.size(), 1), next(cloud.size());
  for (int sweep = 0; sweep < k_factor_sweeps; ++sweep) {
    for (size_t i = 0; i < cloud.size(); ++i) {
      const double sum = std::max(neighbours.sum_at(i, factors), 1e-6);
      const double change = std::clamp(std::max(wanted[i], 1e-6) / sum, 1 / k_most_change, k_most_change);
      next[i] = std::clamp(factors[i] * std::pow(change, k_step), 1 / k_most_taken, k_most_given);
    }
    std::swap(factors, next);
  }
  return factors;
}

} // namespace kelpie
