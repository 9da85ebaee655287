// An axis as it acts on a box: polynomials for SIMD lanes.
#include "field/warps/axis_tube.h"

namespace kelpie {

namespace {

/// Newton's method may go this many times as far as the places of a box lie from their middle.
constexpr double k_room = 1.5;

/// The polynomial of degree 4 through values at five places.
std::array<Mat3d, 5> interpolated(const std::array<double, 5>& x, std::array<Mat3d, 5> values) {
  for (size_t k = 1; k < 5; ++k)
    for (size_t j = 4; j >= k; --j) values[j] = (values[j] - values[j - 1]) / (x[j] - x[j - k]);
  std::array<Mat3d, 5> powers;
  powers.fill(Mat3d(0.0));
  for (size_t j = 5; j-- > 0;) {
    for (size_t k = 4; k > 0; --k) powers[k] = powers[k - 1] - x[j] * powers[k];
    powers[0] = values[j] - x[j] * powers[0];
  }
  return powers;
}

/// How many of Newton's steps from u = 0 find a piece's place for every point of a box, where that lies in [-h, h]; 0 if they may not.
/// Makes h smaller, if places surely lie in less.
int newton_steps(const AxisPiece& piece, const Vec3d& half, double& h) {
  constexpr double k_precise = 1e-6;
  constexpr int k_most = 7;
  const auto& a = piece.axis;
  const auto along = [&](const Vec3d& v) {
    const double middle = glm::dot(v, piece.offset), width = glm::dot(glm::abs(v), half);
    return Interval{middle - width, middle + width};
  };
  // Of f(u) = (offset + d - dc) c', the derivatives.
  const double aa = glm::dot(a[0], a[0]), ab = glm::dot(a[0], a[1]), n2 = 2 * glm::dot(a[1], a[1]) + 4 * glm::dot(a[0], a[2]);
  const double n3 = 5 * glm::dot(a[1], a[2]), n4 = 3 * glm::dot(a[2], a[2]);
  const Interval f2 = 3.0 * along(a[2]) - 3 * ab;
  const auto falls = [&](const Interval& u) {
    return aa - 2.0 * along(a[1]) - u * (2.0 * f2 - u * (3 * n2 + u * (4 * n3 + u * (5 * n4))));
  };
  const double most = along(a[0]).magnitude(); // of f(0)
  for (int i = 0; i < 3; ++i)
    if (const double least = falls({-h, h}).lo; least > 0) h = std::min(h, most / least);
  const Interval u{-k_room * h, k_room * h};
  const Interval bends = 2.0 * f2 - u * (6 * n2 + u * (12 * n3 + u * (20 * n4)));
  const double least = falls(u).lo;
  if (!(least > 0)) return 0;
  const double factor = 0.5 * bends.magnitude() / least;
  int steps = 0;
  for (double error = h; error > k_precise * h; ++steps) {
    if (steps == k_most || factor * error > 0.7) return 0;
    error *= factor * error;
  }
  return std::max(steps, 1);
}

} // namespace

/// In terms of s of `step`, places from `from` to `to`, which may lie beyond its ends in the same section.
bool AxisTube::fit(size_t step, double from, double to, const Box3d& box, double tolerance, AxisPiece& out) const {
  const double middle = 0.5 * (from + to), h = std::max(0.5 * (to - from), 1e-6);
  const size_t end = ends_[step];
  const auto in_step = [&](double s, size_t& k) {
    k = std::min(step + static_cast<size_t>(std::max(s, 0.0)), end - 1);
    return s - static_cast<double>(k - step);
  };
  size_t k = 0;
  const auto turn_at = [&](double u) {
    const double s = in_step(middle + u, k);
    return turns_[k].turn(s);
  };
  const double at = in_step(middle, k);
  const CubicStep<Vec3d>&c = deformed_.step(k), &shift = turns_[k].shift;
  out.joint = static_cast<double>(end - step) - middle;
  out.offset = box.centre() - c(at);
  out.axis = {c.first(at), 0.5 * c.second(at), c.a[3]};
  out.shift = {shift(at), shift.first(at), 0.5 * shift.second(at), shift.a[3]};
  constexpr std::array<double, 5> k_nodes{-0.9510565162951535, -0.5877852522924731, 0, 0.5877852522924731, 0.9510565162951535};
  std::array<Mat3d, 5> values;
  for (size_t i = 0; i < 5; ++i) values[i] = turn_at(h * k_nodes[i]);
  const std::array<Mat3d, 5> powers = interpolated(k_nodes, values);
  double error = 0;
  for (const double x : {-1.0, -0.8, -0.3, 0.3, 0.8, 1.0})
    error = std::max(error, most_entry(powers[0] + x * (powers[1] + x * (powers[2] + x * (powers[3] + x * powers[4]))) - turn_at(h * x)));
  if (!(error * most_reach_ <= tolerance + 2 * k_frame_precision * most_reach_)) return false;
  double power = 1;
  for (size_t i = 0; i < 5; ++i, power *= h) out.turn[i] = powers[i] / power;
  double places = h;
  out.newton_steps = newton_steps(out, box.extent() * 0.5, places);
  out.low = -k_room * places, out.high = k_room * places;
  if (step == 0) out.low = std::max(out.low, -middle);
  if (end == turns_.size()) out.high = std::min(out.high, out.joint);
  return out.newton_steps > 0;
}

bool AxisTube::pieces(const Box3d& box, double tolerance, std::vector<AxisPiece>& out) const {
  thread_local AxisRange range;
  deformed_.find(box, range);
  out.clear();
  if (!range.is_inside) return false;
  const std::vector<AxisPart>& parts = range.parts;
  for (size_t i = 0; i < parts.size();) {
    size_t last = i;
    while (last + 1 < parts.size() && parts[last + 1].step < ends_[parts[i].step]) ++last;
    const double to = static_cast<double>(parts[last].step - parts[i].step) + parts[last].to;
    if (!fit(parts[i].step, parts[i].from, to, box, tolerance, out.emplace_back())) return false;
    i = last + 1;
  }
  return true;
}

} // namespace kelpie
