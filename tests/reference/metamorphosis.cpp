#include "tests/reference/metamorphosis.h"

#include <algorithm>
#include <cmath>

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
    const double near = std::clamp(1 + distances[i] * mix.reach / feature.fade, 0.0, 1.0), there = std::clamp(g / threshold, 0.0, 1.0);
    value += weights[i] * (g + threshold * feature.offset / mix.reach * near * there);
  }
  return value;
}

} // namespace reference
