#include "morph/tree/computed.h"

#include <cmath>

namespace kelpie {

Animated<Vec3> turned(const Animated<Vec3>& a, const Animated<Vec3>& b, const Animated<float>& s) {
  const auto turn = [](const Vec3& x, const Vec3& y, float t) {
    if (t == 0) return x;
    if (t == 1) return y;
    const Vec3d from = glm::normalize(Vec3d(x)), to = glm::normalize(Vec3d(y));
    const double cosine = std::clamp(glm::dot(from, to), -1.0, 1.0), angle = std::acos(cosine) * double(t);
    Vec3d aside = to - cosine * from;
    if (!(glm::length(aside) > 1e-6)) { // the same, or opposite: about any axis
      if (cosine > 0) return x;
      aside = std::abs(from.x) < 0.6 ? Vec3d(1, 0, 0) : Vec3d(0, 1, 0);
      aside -= glm::dot(aside, from) * from;
    }
    return Vec3(std::cos(angle) * from + std::sin(angle) * glm::normalize(aside));
  };
  return computed<Vec3>(turn, a, b, s);
}

} // namespace kelpie
