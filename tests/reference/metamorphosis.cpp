#include "tests/reference/metamorphosis.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace reference {

namespace {

Vec cross(Vec a, Vec b) { return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x}; }

/// A rotation by its columns.
using Rotation = std::array<Vec, 3>;

Rotation axes(const Element& e) {
  const Vec y = e.axis * (1 / length(e.axis)), rest = e.across - y * dot(e.across, y), x = rest * (1 / length(rest));
  return {x, y, cross(x, y)};
}

/// a^T b, as columns.
Rotation between(const Rotation& a, const Rotation& b) {
  Rotation r;
  for (int i = 0; i < 3; ++i) r[i] = {dot(a[0], b[i]), dot(a[1], b[i]), dot(a[2], b[i])};
  return r;
}

/// Its axis times its angle, which is less than pi.
Vec logarithm(const Rotation& r) {
  const Vec twice_sine{r[1].z - r[2].y, r[2].x - r[0].z, r[0].y - r[1].x};
  const double sine = length(twice_sine) / 2, cosine = (r[0].x + r[1].y + r[2].z - 1) / 2;
  return sine > 1e-12 ? twice_sine * (std::atan2(sine, cosine) / (2 * sine)) : Vec{};
}

/// Rodrigues' formula.
Vec turned(Vec v, Vec by) {
  const double angle = length(by);
  if (angle == 0) return v;
  const Vec e = by * (1 / angle);
  return v * std::cos(angle) + cross(e, v) * std::sin(angle) + e * (dot(e, v) * (1 - std::cos(angle)));
}

Vec in_world(const Rotation& r, Vec v) { return r[0] * v.x + r[1] * v.y + r[2] * v.z; }

struct Weighted {
  Element element;
  double weight;
};

/// Of the objects that have the element: all alike where none of them has a weight.
std::vector<Weighted> elements_of(const Mix& mix, const MixFeature& feature) {
  std::vector<Weighted> all;
  double sum = 0;
  for (size_t j = 0; j < mix.objects.size(); ++j)
    for (const Element& e : mix.objects[j])
      if (e.name == feature.name) all.push_back({e, feature.frame_weights[j]}), sum += feature.frame_weights[j];
  for (Weighted& w : all) w.weight = sum > 0 ? w.weight / sum : 1.0 / double(all.size());
  return all;
}

/// Down the gradient of the sum of weighted squared angles, from the rotation of the largest weight.
Rotation mean(const std::vector<Weighted>& all) {
  const auto first = std::max_element(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.weight < b.weight; });
  Rotation at = axes(first->element);
  for (int step = 0; step < 400; ++step) {
    Vec turn;
    for (const Weighted& w : all) turn = turn + logarithm(between(at, axes(w.element))) * w.weight;
    const Vec world = in_world(at, turn * 0.5);
    for (Vec& axis : at) axis = turned(axis, world);
  }
  return at;
}

} // namespace

Element mean_element(const Mix& mix, const MixFeature& feature) {
  const std::vector<Weighted> all = elements_of(mix, feature);
  Element out{feature.name, {}, {}, {}, {}, 0};
  for (const Weighted& w : all) {
    out.centre = out.centre + w.element.centre * w.weight, out.size = out.size + w.element.size * w.weight;
    out.rounding += w.element.rounding * w.weight;
  }
  const Rotation r = mean(all);
  out.across = r[0], out.axis = r[1];
  return out;
}

Affine object_from_child(const Mix& mix, const MixFeature& feature, size_t object) {
  for (const Element& own : mix.objects[object]) {
    if (own.name != feature.name) continue;
    const Element child = mean_element(mix, feature);
    const Rotation from = axes(child), to = axes(own);
    const Vec scale{own.size.x / child.size.x, own.size.y / child.size.y, own.size.z / child.size.z};
    Affine map;
    const auto row = [&](double Vec::*i) {
      return from[0] * (to[0].*i * scale.x) + from[1] * (to[1].*i * scale.y) + from[2] * (to[2].*i * scale.z);
    };
    map.rows = {row(&Vec::x), row(&Vec::y), row(&Vec::z)};
    map.offset = own.centre - map.direction(child.centre);
    return map;
  }
  return {};
}

std::vector<double> feature_weights(const Mix& mix, std::vector<double> d) {
  if (mix.features.back().is_background) {
    const double nearest = d.empty() ? -1 : *std::max_element(d.begin(), d.end());
    d.push_back(-nearest - mix.margin / mix.reach);
  }
  const double best = *std::max_element(d.begin(), d.end());
  std::vector<double> weights;
  double sum = 0;
  for (const double x : d) {
    const double part = best > 0 ? std::max(0.0, x) / best : x == best ? 1 : std::abs(best) / std::abs(x);
    weights.push_back(std::pow(part, mix.sharpness)), sum += weights.back();
  }
  for (double& w : weights) w /= sum;
  return weights;
}

namespace {

/// Space-time blending, as methods.md has it.
struct SpaceTime {
  double f1, f2, f3, a1, a2, a3;

  static double meet(double x, double y) { return x + y - std::hypot(x, y); }
  static double bump(double r) { return r < 1 ? std::pow(1 - r, 3) / (1 + r) : 0; }
  static double ratio(double p, double q) { return p + q > 0 ? p / (p + q) : 1; }

  SpaceTime(const Mix& mix, size_t i, size_t j, double g1, double g2, double t, double unit)
      : a1(mix.influences[i]), a2(mix.influences[j]), a3(mix.time_influence) {
    const double p = mix.passage, tau = (1 + 2 * p) * t - p;
    const auto half = [&](double g, double from_end) {
      const double r = ratio(g * g + from_end * from_end, std::pow(std::max(0.0, from_end + p / 2), 2));
      return meet(g, -from_end) - 0.2 * bump(r);
    };
    f1 = half(g1 / unit, tau), f2 = half(g2 / unit, 1 - tau), f3 = meet(tau + p, 1 + p - tau);
  }
  double section(double displacement) const {
    const double r1 = std::hypot(f1 / a1, f2 / a2), r2 = f3 > 0 ? f3 / a3 : 0;
    return f1 + f2 + std::hypot(f1, f2) + displacement * bump(ratio(r1 * r1, r2 * r2));
  }
};

/// Calls visit(j, k, flow) for each two objects.
template <class Visit>
void for_each_two(const Mix& mix, const MixFeature& feature, const Visit& visit) {
  size_t which = 0;
  for (size_t j = 0; j < mix.objects.size(); ++j)
    for (size_t k = j + 1; k < mix.objects.size(); ++k) visit(j, k, feature.flows[which++]);
}

/// The distance that feature i makes of those to the objects.
double blended(const Mix& mix, const MixFeature& feature, const std::vector<double>& g) {
  double value = 0, sum = 0;
  for_each_two(mix, feature, [&](size_t j, size_t k, const Flow& flow) {
    const double v = feature.weights[j], w = feature.weights[k];
    if (v * w == 0) return;
    const double t = w / (v + w), near = std::min(t, 1 - t) * std::max(4.0, 1 + 2 * mix.passage), x = std::min(near, 1.0);
    const double fade = 3 * x * x - 2 * x * x * x;
    const double section = flow.unit * SpaceTime(mix, j, k, g[j], g[k], t, flow.unit).section(flow.displacement);
    value += v * w * (fade * section + (1 - fade) * (t < 0.5 ? g[j] : g[k])), sum += v * w;
  });
  if (sum > 0) return value / sum;
  return g[size_t(std::max_element(feature.weights.begin(), feature.weights.end()) - feature.weights.begin())];
}

} // namespace

std::vector<double> object_shares(const Mix& mix, size_t i, const std::vector<double>& g) {
  const MixFeature& feature = mix.features[i];
  std::vector<double> shares(g.size(), 0.0);
  double sum = 0;
  if (mix.is_space_time)
    for_each_two(mix, feature, [&](size_t j, size_t k, const Flow& flow) {
      const double v = feature.weights[j], w = feature.weights[k], product = v * w;
      if (product == 0) return;
      const SpaceTime at(mix, j, k, g[j], g[k], w / (v + w), flow.unit);
      const double out1 = std::max(0.0, -at.f1), out2 = std::max(0.0, -at.f2); // 0 inside a half-cylinder, which is then its own
      const double first = out1 + out2 > 0 ? out2 / (out1 + out2) : 0.5;
      shares[j] += product * first, shares[k] += product * (1 - first), sum += product;
    });
  if (sum == 0) shares = feature.weights, sum = std::accumulate(shares.begin(), shares.end(), 0.0);
  for (double& s : shares) s /= sum;
  return shares;
}

double mixed(const Mix& mix, const std::vector<double>& f, double threshold) {
  const size_t elements = mix.features.size() - (mix.features.back().is_background ? 1 : 0);
  std::vector<double> distances;
  for (size_t i = 0; i < elements; ++i) distances.push_back(f[i] / threshold - 1);
  const std::vector<double> weights = feature_weights(mix, distances);
  if (elements < mix.features.size())
    distances.push_back(-(distances.empty() ? -1 : *std::max_element(distances.begin(), distances.end())) - mix.margin / mix.reach);
  double value = 0;
  for (size_t i = 0; i < mix.features.size(); ++i) {
    const MixFeature& feature = mix.features[i];
    double g = 0, sum = 0;
    for (size_t j = 0; j < mix.objects.size(); ++j)
      g += feature.weights[j] * f[elements + i * mix.objects.size() + j], sum += feature.weights[j];
    g /= sum;
    if (mix.is_space_time) {
      std::vector<double> to_objects;
      for (size_t j = 0; j < mix.objects.size(); ++j)
        to_objects.push_back(mix.reach * (f[elements + i * mix.objects.size() + j] / threshold - 1));
      g = std::max(0.0, threshold * (1 + blended(mix, feature, to_objects) / mix.reach));
    }
    const double near = std::clamp(1 + distances[i] * mix.reach / feature.fade, 0.0, 1.0), there = std::clamp(g / threshold, 0.0, 1.0);
    value += weights[i] * (g + threshold * feature.offset / mix.reach * near * there);
  }
  return value;
}

} // namespace reference
