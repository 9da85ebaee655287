#include "morph/tree/limbs.h"

#include <array>

#include "base/spline.h"
#include "morph/tree/computed.h"

namespace kelpie {

namespace {

using Limb = GeneralizedCylinder<AnimatedMode>;

/// The sum of some values, each as much as a weight says.
template <class T>
class WeightedSum final : public TimeFunction<T> {
public:
  struct Term {
    float weight;
    Animated<T> value;
  };
  explicit WeightedSum(std::vector<Term> terms) : terms_(std::move(terms)) {}

  T at(double frame) const override {
    T sum{};
    for (const Term& term : terms_) sum += term.weight * term.value.at(frame);
    return sum;
  }
  std::vector<double> frames() const override {
    return united([](const Animated<T>& value) { return value.frames(); });
  }
  std::vector<double> breaks(double from, double to) const override {
    return united([&](const Animated<T>& value) { return value.breaks(from, to); });
  }

private:
  template <class FramesOf>
  std::vector<double> united(const FramesOf& frames_of) const {
    std::vector<double> all;
    for (const Term& term : terms_) {
      const std::vector<double> frames = frames_of(term.value);
      all.insert(all.end(), frames.begin(), frames.end());
    }
    return sorted_once(std::move(all));
  }

  std::vector<Term> terms_;
};

/// Control points of cubic Bézier pieces as weights of the points of a curve: a row of them for each.
using Weights = std::vector<std::vector<double>>;

/// The Bézier points of a polynomial, given by powers, from u to v.
std::array<double, 4> bezier_points(std::span<const double> powers, double u, double v) {
  std::array<double, 4> a{};
  std::copy(powers.begin(), powers.end(), a.begin());
  const double h = v - u;
  const double b0 = a[0] + u * (a[1] + u * (a[2] + u * a[3])), b1 = h * (a[1] + u * (2 * a[2] + 3 * u * a[3]));
  const double b2 = h * h * (a[2] + 3 * u * a[3]), b3 = h * h * h * a[3];
  return {b0, b0 + b1 / 3, b0 + (2 * b1 + b2) / 3, b0 + b1 + b2 + b3};
}

int piece_count(const Limb& limb) {
  constexpr size_t k_most_points = 1000; // their weights are a square table
  if (limb.points.size() > k_most_points) return 0;
  const std::vector<double> points(limb.points.size());
  const auto curve = Spline<double>::make(limb.curve, points);
  return curve.degree() >= 1 && curve.degree() <= 3 ? curve.pieces() : 0;
}

/// Of `pieces` pieces, at least as many as the curve has: some of those are divided.
Weights bezier_weights(const Limb& limb, int pieces) {
  const size_t n = limb.points.size();
  Weights weights(size_t(3 * pieces + 1), std::vector<double>(n));
  for (size_t j = 0; j < n; ++j) { // where one point is 1 and the others are 0, its weights are the curve
    std::vector<double> one(n);
    one[j] = 1;
    const auto curve = Spline<double>::make(limb.curve, one);
    const int own = curve.pieces();
    for (int i = 0, next = 0; i < own; ++i) {
      const int parts = (i + 1) * pieces / own - i * pieces / own;
      for (int k = 0; k < parts; ++k, ++next) {
        const auto points = bezier_points(curve.coefficients(i), double(k) / parts, double(k + 1) / parts);
        for (size_t m = 0; m < 4; ++m) weights[size_t(3 * next) + m][j] = points[m];
      }
    }
  }
  return weights;
}

template <class T>
std::vector<Animated<T>> weighted(const Weights& weights, const std::vector<Animated<T>>& values) {
  std::vector<Animated<T>> out;
  for (const std::vector<double>& row : weights) {
    std::vector<typename WeightedSum<T>::Term> terms;
    bool moves = false;
    for (size_t j = 0; j < row.size(); ++j)
      if (row[j] != 0) terms.push_back({float(row[j]), values[j]}), moves |= !values[j].is_constant();
    auto sum = std::make_shared<WeightedSum<T>>(std::move(terms));
    out.push_back(moves ? Animated<T>(std::shared_ptr<const TimeFunction<T>>(std::move(sum))) : Animated<T>(sum->at(0)));
  }
  return out;
}

void become_beziers(Limb& limb, int pieces) {
  const Weights weights = bezier_weights(limb, pieces);
  std::vector<Animated<float>> radii = limb.radii.empty() ? std::vector<Animated<float>>{0.f} : limb.radii;
  radii.resize(limb.points.size(), radii.front());
  limb.points = weighted(weights, limb.points), limb.radii = weighted(weights, radii);
  limb.curve = SplineKind::cubic_beziers;
}

} // namespace

void give_equal_pieces(Limb& a, Limb& b) {
  const bool in_units = a.detail > 0 && b.detail > 0;
  a.detail = b.detail = in_units ? std::min(a.detail, b.detail) : 0;
  a.detail_pixels = b.detail_pixels = std::min(a.detail_pixels, b.detail_pixels);
  if (a.curve == b.curve && a.points.size() == b.points.size()) return;
  const int pieces_a = piece_count(a), pieces_b = piece_count(b);
  if (pieces_a == 0 || pieces_b == 0) return;
  for (Limb* limb : {&a, &b}) become_beziers(*limb, std::max(pieces_a, pieces_b));
}

} // namespace kelpie
