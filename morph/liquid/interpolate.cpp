#include "morph/liquid/interpolate.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "morph/liquid/match.h"
#include "morph/liquid/volume.h"

namespace kelpie {

namespace {

/// Gains are found at this many equal steps: half a frame of a morph of two seconds.
constexpr int k_gain_steps = 64;

/// A shape of some percent of its cloud's box still covers thousands of cells.
constexpr size_t k_volume_cells = 250'000;

template <class T>
T lerp(T a, T b, float u) {
  return a * (1 - u) + b * u;
}

float cube(float x) { return x * x * x; }

} // namespace

LiquidMorph::LiquidMorph(const BlobCloud& from, const BlobCloud& to, Correspondence how, VolumeRule rule)
    : from_(from), to_(to), how_(how) {
  const auto end = [](const Blob& b, float share) {
    End e{b.centre, shape_of(b), b.radius, b.weight * cube(b.radius) * share, b.falloff};
    e.shape.weight *= share;
    return e;
  };
  for (const Link& l : match_blobs(from, to, how)) parts_.push_back({end(from[l.from], l.from_share), end(to[l.to], l.to_share)});
  for (uint32_t i = 0; i < parts_.size(); ++i) part_of_blob_.insert(part_of_blob_.end(), is_of_two_falloffs(parts_[i]) ? 2 : 1, i);
  if (rule == VolumeRule::linear) find_gains();
}

void LiquidMorph::append_blobs(float progress, BlobCloud& out) const {
  if (progress <= 0)
    out.insert(out.end(), from_.begin(), from_.end());
  else if (progress >= 1)
    out.insert(out.end(), to_.begin(), to_.end());
  else
    append_parts(progress, gain_at(progress), out);
}

Blob LiquidMorph::interpolate(const Part& p, float u, float gain) const {
  const Vec3 centre = lerp(p.from.centre, p.to.centre, u);
  if (how_ == Correspondence::cellular) {
    const BlobShape &a = p.from.shape, &b = p.to.shape;
    return to_blob({lerp(a.sphere_radius, b.sphere_radius, u), lerp(a.stiffness, b.stiffness, u), lerp(a.weight, b.weight, u) * gain},
                   centre, p.from.falloff);
  }
  // Weights that moved linearly by themselves would multiply the mass of a part between a large and a small blob. The cube of the
  // radius, moved linearly, stays large too long: thin limbs were spread out below the threshold.
  const float volume = cube(lerp(p.from.radius, p.to.radius, u));
  return {centre, std::cbrt(volume), lerp(p.from.mass, p.to.mass, u) / volume * gain, p.from.falloff};
}

void LiquidMorph::append_parts(float u, float gain, BlobCloud& out) const {
  for (const Part& p : parts_) {
    Blob b = interpolate(p, u, gain);
    if (is_of_two_falloffs(p)) { // they dissolve into one another
      Blob other = b;
      other.falloff = p.to.falloff, other.weight *= u;
      out.push_back(other);
      b.weight *= 1 - u;
    }
    out.push_back(b);
  }
}

void LiquidMorph::find_gains() {
  Box3 box;
  for (const Blob& b : from_) box.extend(support(b));
  for (const Blob& b : to_) box.extend(support(b));
  const VolumeGrid grid(box, k_volume_cells);
  const double first = grid.volume(from_), last = grid.volume(to_);
  gain_.assign(k_gain_steps + 1, 1.f);
  if (first == 0 || last == 0) return; // an end without a surface: nothing to be linear between
  parallel_for(1, k_gain_steps, [&](int i) {
    const float u = static_cast<float>(i) / k_gain_steps;
    BlobCloud cloud;
    append_parts(u, 1, cloud);
    gain_[i] = static_cast<float>(grid.gain_for_volume(cloud, lerp(first, last, u)));
  });
}

float LiquidMorph::gain_at(float progress) const {
  if (gain_.empty()) return 1;
  const float x = progress * k_gain_steps;
  const int i = std::clamp(static_cast<int>(x), 0, k_gain_steps - 1);
  const float u = x - static_cast<float>(i);
  const float g0 = gain_[std::max(i - 1, 0)], g1 = gain_[i], g2 = gain_[i + 1], g3 = gain_[std::min(i + 2, k_gain_steps)];
  // Catmull–Rom: the gain's rate of change has no steps, or the liquid would jerk.
  return g1 + 0.5f * u * (g2 - g0 + u * (2 * g0 - 5 * g1 + 4 * g2 - g3 + u * (3 * (g1 - g2) + g3 - g0)));
}

} // namespace kelpie
