#include "renderer/measure/bumps.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace kelpie {

namespace {

constexpr double k_sigma = 3;   // pixels
constexpr int k_kernel = 12;    // pixels to either side: four times k_sigma
constexpr int k_silhouette = 5; // pixels
constexpr size_t k_fewest = 50;

/// One value a pixel, row by row.
struct Plane2d {
  int width = 0, height = 0;
  std::vector<float> values;

  float at(int x, int y) const { return values[size_t(y) * size_t(width) + size_t(x)]; }
};

/// Smoothed along x and turned, so that twice is both axes. Beyond the edge the picture is mirrored.
Plane2d smoothed_and_turned(const Plane2d& in) {
  double kernel[2 * k_kernel + 1], sum = 0;
  for (int i = -k_kernel; i <= k_kernel; ++i) sum += kernel[i + k_kernel] = std::exp(-0.5 * i * i / (k_sigma * k_sigma));
  Plane2d out{in.height, in.width, std::vector<float>(in.values.size())};
  const int period = 2 * in.width;
  for (int y = 0; y < in.height; ++y)
    for (int x = 0; x < in.width; ++x) {
      double value = 0;
      for (int i = -k_kernel; i <= k_kernel; ++i) {
        const int place = ((x + i) % period + period) % period;
        value += kernel[i + k_kernel] * in.at(place < in.width ? place : period - 1 - place, y);
      }
      out.values[size_t(x) * size_t(in.height) + size_t(y)] = static_cast<float>(value / sum);
    }
  return out;
}

/// Without the pixels of which a neighbour is none.
std::vector<bool> eroded(const std::vector<bool>& in, int width, int height) {
  std::vector<bool> out(in.size());
  for (int y = 1; y + 1 < height; ++y)
    for (int x = 1; x + 1 < width; ++x) {
      const size_t i = size_t(y) * size_t(width) + size_t(x), row = size_t(width);
      out[i] = in[i] && in[i - 1] && in[i + 1] && in[i - row] && in[i + row];
    }
  return out;
}

/// Between the two nearest of the sorted values.
double quantile(const std::vector<double>& sorted, double share) {
  const double place = share * double(sorted.size() - 1);
  const size_t i = size_t(place);
  return std::lerp(sorted[i], sorted[std::min(i + 1, sorted.size() - 1)], place - double(i));
}

} // namespace

std::optional<Bumps> bumps_of(const FrameImage& image) {
  const int width = image.data_window.width(), height = image.data_window.height();
  std::array<Plane2d, 3> normal, smooth;
  for (size_t c = 0; c < 3; ++c) {
    normal[c] = {width, height, image.find(c == 0 ? "N.X" : c == 1 ? "N.Y" : "N.Z")->pixels};
    smooth[c] = smoothed_and_turned(smoothed_and_turned(normal[c]));
  }
  const auto at = [](const std::array<Plane2d, 3>& n, size_t i) { return Vec3d(n[0].values[i], n[1].values[i], n[2].values[i]); };
  std::vector<bool> counts(image.data_window.area());
  for (size_t i = 0; i < counts.size(); ++i) counts[i] = glm::length(at(normal, i)) > 0.5;
  for (int i = 0; i < k_silhouette; ++i) counts = eroded(counts, width, height);
  std::vector<double> angles;
  for (size_t i = 0; i < counts.size(); ++i) {
    if (!counts[i]) continue;
    const Vec3d a = glm::normalize(at(normal, i)), b = at(smooth, i);
    const double length = glm::length(b);
    if (length > 0) angles.push_back(std::acos(std::clamp(glm::dot(a, b) / length, -1.0, 1.0)) * 180 / std::numbers::pi);
  }
  if (angles.size() < k_fewest) return {};
  std::sort(angles.begin(), angles.end());
  return Bumps{quantile(angles, 0.5), quantile(angles, 0.9)};
}

} // namespace kelpie
