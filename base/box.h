// Axis-aligned boxes in scene units.
#pragma once

#include <algorithm>
#include <limits>

#include "base/vec.h"

namespace kelpie {

/// A closed box [lower, upper]. The default is empty (lower > upper): the neutral element of `extend`.
template <class T>
struct BoxT {
  using Vec = glm::vec<3, T>;
  Vec lower{std::numeric_limits<T>::infinity()};
  Vec upper{-std::numeric_limits<T>::infinity()};

  bool is_empty() const { return !(lower.x <= upper.x && lower.y <= upper.y && lower.z <= upper.z); }
  Vec centre() const { return (lower + upper) * T(0.5); }
  Vec extent() const { return upper - lower; }
  T diagonal() const { return is_empty() ? T(0) : glm::length(extent()); }
  bool contains(const Vec& p) const { return glm::all(glm::lessThanEqual(lower, p)) && glm::all(glm::lessThanEqual(p, upper)); }
  void extend(const Vec& p) { lower = glm::min(lower, p), upper = glm::max(upper, p); }
  void extend(const BoxT& b) { lower = glm::min(lower, b.lower), upper = glm::max(upper, b.upper); }
  BoxT padded(T by) const { return {lower - Vec(by), upper + Vec(by)}; }
  friend BoxT intersect(const BoxT& a, const BoxT& b) { return {glm::max(a.lower, b.lower), glm::min(a.upper, b.upper)}; }
};

using Box3 = BoxT<float>;
using Box3d = BoxT<double>;

} // namespace kelpie
