#include "renderer/measure/pops.h"

#include <algorithm>

namespace kelpie {

double usual_change(std::span<const double> changes, size_t at) {
  const size_t window = std::min(changes.size(), k_pop_neighbours + 1);
  const size_t first = std::min(at - std::min(at, k_pop_neighbours / 2), changes.size() - window);
  std::vector<double> others;
  for (size_t i = first; i < first + window; ++i)
    if (i != at) others.push_back(changes[i]);
  if (others.empty()) return 0;
  std::sort(others.begin(), others.end());
  return 0.5 * (others[(others.size() - 1) / 2] + others[others.size() / 2]);
}

std::vector<size_t> find_pops(std::span<const double> changes) {
  std::vector<size_t> pops;
  if (changes.size() < 2) return pops; // nothing to compare with
  for (size_t i = 0; i < changes.size(); ++i)
    if (changes[i] > k_least_pop && changes[i] > k_pop_factor * usual_change(changes, i)) pops.push_back(i);
  return pops;
}

} // namespace kelpie
