#include "morph/liquid/interpolate.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "morph/liquid/body_graph.h"
#include "morph/liquid/flow_path.h"
#include "morph/liquid/local_balance.h"
#include "morph/liquid/spread.h"
#include "morph/liquid/volume.h"

namespace kelpie {

namespace {

/// Gains are found at this many equal steps: a frame of a morph of a second.
constexpr int k_gain_steps = 32;

/// Ways are led aside at this many, fully from this progress on, from either end.
constexpr int k_spread_steps = 24;
constexpr float k_spread_from = 0.25f;

/// Balances are found at this many: they change slowly.
constexpr int k_balance_steps = 32;

/// The progress in which the parts of a blob have left one another.
constexpr float k_parting = 0.35f;

/// How much wider than a ball of its volume a part is, so that those of one blob go on as one liquid.
constexpr float k_spread = 2;

/// The radius of influence of the least drop, as a share of the diagonal of both clouds' box.
constexpr float k_drop = 0.08f;

/// What the sum at a part's centre is at most, far from the ends: where much passes through a thin place it does not swell into a ball.
constexpr double k_most_on_the_way = 1.3;

/// A shape of some percent of its cloud's box still covers thousands of cells.
constexpr size_t k_volume_cells = 250'000;

template <class T>
T lerp(T a, T b, float u) {
  return a * (1 - u) + b * u;
}

float cube(float x) { return x * x * x; }

float smooth_step(float x) {
  const float v = std::clamp(x, 0.f, 1.f);
  return v * v * (3 - 2 * v);
}

} // namespace

LiquidMorph::LiquidMorph(const BlobCloud& from, const BlobCloud& to, Correspondence how, VolumeRule rule, LiquidEnds at_from,
                         LiquidEnds at_to)
    : from_(from), to_(to), how_(how), at_from_(at_from), at_to_(at_to) {
  for (const Blob& b : from_) box_.extend(support(b));
  for (const Blob& b : to_) box_.extend(support(b));
  drop_radius_ = k_drop * box_.diagonal();
  if (how == Correspondence::flow) {
    const BodyGraph bodies(from, to);
    add_parts(match_transport(from, to, bodies), &bodies);
    spread_parts();
    find_balance();
  } else {
    add_parts(how == Correspondence::transport ? match_transport(from, to) : match_cellular(from, to), nullptr);
  }
  if (rule == VolumeRule::linear) find_gains();
}

/// Along their ways through the bodies, if there are any.
void LiquidMorph::add_parts(const std::vector<Link>& links, const BodyGraph* bodies) {
  const auto end = [](const Blob& b, float share) {
    End e{b.centre, shape_of(b), b.radius, b.weight * cube(b.radius) * share, b.falloff, b.shape};
    e.shape.weight *= share;
    return e;
  };
  for (const Link& l : links) {
    const Blob &a = from_[l.from], &b = to_[l.to];
    const std::vector<Vec3d> way = bodies ? bodies->way(l.from, l.to) : std::vector<Vec3d>{Vec3d(a.centre), Vec3d(b.centre)};
    parts_.push_back({end(a, l.from_share), end(b, l.to_share), l, flow_path(way)});
  }
  for (uint32_t i = 0; i < parts_.size(); ++i) part_of_blob_.insert(part_of_blob_.end(), is_of_two_falloffs(i) ? 2 : 1, i);
}

void LiquidMorph::append_blobs(float progress, BlobCloud& out) const {
  if (progress <= 0 && !is_molten(at_from_))
    out.insert(out.end(), from_.begin(), from_.end());
  else if (progress >= 1 && !is_molten(at_to_))
    out.insert(out.end(), to_.begin(), to_.end());
  else
    append_parts(progress, gain_at(progress), out);
}

/// 0 at the beginning, if that is exact, 1 from k_parting on; smooth.
float LiquidMorph::away_from(float u) const { return is_molten(at_from_) ? 1 : smooth_step(u / k_parting); }

/// The same of the end.
float LiquidMorph::away_to(float u) const { return is_molten(at_to_) ? 1 : smooth_step((1 - u) / k_parting); }

/// On the way a part has the volume of its share of its blob, and no less than a drop's: what is smaller spreads until it is no surface of
/// its own, and shows only where it meets others. So crumbs do not fly, and thin limbs are drawn in and out. Near the ends, where the
/// parts of a blob are still, or again, together, it has the blob's radius.
float LiquidMorph::flow_radius(const Part& p, float u) const {
  const float a = std::log(p.from.radius), b = std::log(p.to.radius);
  const float own_a = a + std::min(0.f, std::log(k_spread * std::cbrt(p.link.from_share)));
  const float own_b = b + std::min(0.f, std::log(k_spread * std::cbrt(p.link.to_share)));
  const float left = away_from(u), arriving = away_to(u);
  const float radius = std::exp(lerp(own_a, own_b, u) + (a - own_a) * (1 - left) + (b - own_b) * (1 - arriving));
  return std::cbrt(cube(radius) + cube(drop_radius_ * left * arriving));
}

/// What flows is round: plates and rods are for the ends.
SymmetricMat3 LiquidMorph::form(const Part& p, float u) const {
  const SymmetricMat3 straight = between(p.from.form, p.to.form, u);
  if (how_ != Correspondence::flow) return straight;
  return between(straight, SymmetricMat3{}, away_from(u) * away_to(u));
}

Blob LiquidMorph::interpolate(const Part& p, float u, float gain) const {
  const Vec3 centre(p.path(u));
  if (p.balance) gain *= static_cast<float>(std::exp((*p.balance)(u)));
  if (how_ == Correspondence::cellular) {
    const BlobShape &a = p.from.shape, &b = p.to.shape;
    Blob out = to_blob({lerp(a.sphere_radius, b.sphere_radius, u), lerp(a.stiffness, b.stiffness, u), lerp(a.weight, b.weight, u) * gain},
                       centre, p.from.falloff);
    out.shape = form(p, u);
    return out;
  }
  // Weights that moved linearly by themselves would multiply the mass of a part between a large and a small blob. The cube of the
  // radius, moved linearly, stays large too long: thin limbs were spread out below the threshold.
  const float volume = how_ == Correspondence::flow ? cube(flow_radius(p, u)) : cube(lerp(p.from.radius, p.to.radius, u));
  return {centre, std::cbrt(volume), lerp(p.from.mass, p.to.mass, u) / volume * gain, p.from.falloff, form(p, u)};
}

void LiquidMorph::append_parts(float u, float gain, BlobCloud& out) const {
  for (size_t i = 0; i < parts_.size(); ++i) {
    const PartBlobs part = part_at(i, u, gain);
    if (part.other) out.push_back(*part.other);
    out.push_back(part.blob);
  }
}

/// Leads ways aside where they run together: at equal steps of progress, fully once the ends are left behind.
void LiquidMorph::spread_parts() {
  const auto parts_at = [&](float u) {
    std::vector<LiquidPart> parts;
    for (const Part& p : parts_) parts.push_back({p.path(u), flow_radius(p, u), lerp(p.from.mass, p.to.mass, u)});
    return parts;
  };
  const std::vector<double> first = densities(parts_at(0)), last = densities(parts_at(1));
  std::vector<std::vector<Vec3d>> ways(parts_.size(), std::vector<Vec3d>(k_spread_steps + 1));
  parallel_for(0, k_spread_steps + 1, [&](int step) {
    const float u = static_cast<float>(step) / k_spread_steps;
    std::vector<LiquidPart> parts = parts_at(u);
    for (size_t i = 0; i < parts.size(); ++i) parts[i].wanted = lerp(first[i], last[i], double(u));
    const double share = smooth_step(u / k_spread_from) * smooth_step((1 - u) / k_spread_from);
    const std::vector<Vec3d> evened = share > 0 ? spread(parts) : std::vector<Vec3d>(parts.size());
    for (size_t i = 0; i < parts.size(); ++i)
      ways[i][static_cast<size_t>(step)] = parts[i].centre + (share > 0 ? share * (evened[i] - parts[i].centre) : Vec3d(0));
  });
  for (size_t i = 0; i < parts_.size(); ++i) parts_[i].path = Spline<Vec3d>::catmull_rom(ways[i]);
}

LiquidMorph::PartBlobs LiquidMorph::part_at(size_t part, float u, float gain) const {
  const Part& p = parts_[part];
  PartBlobs out{interpolate(p, u, gain), {}};
  if (!is_of_two_falloffs(part)) return out;
  out.other = out.blob; // they dissolve into one another
  out.other->falloff = p.to.falloff, out.other->weight *= u;
  out.blob.weight *= 1 - u;
  return out;
}

/// Of so many equal steps those at which something is to be found: exact ends are as they are.
std::pair<int, int> LiquidMorph::free_steps(int steps) const {
  return {is_molten(at_from_) ? 0 : 1, is_molten(at_to_) ? steps + 1 : steps};
}

/// Finds each part's own factor, at equal steps of progress. Without it parts that meet in a neck pile up; one common factor that makes
/// up for the volume then starves all others.
void LiquidMorph::find_balance() {
  const auto wanted_of = [&](float u) {
    BlobCloud cloud;
    append_parts(u, 1, cloud);
    return potentials_at_centres(cloud);
  };
  const std::vector<double> first = wanted_of(0), last = wanted_of(1);
  const auto [begin, end] = free_steps(k_balance_steps);
  std::vector<std::vector<double>> logarithms(parts_.size(), std::vector<double>(k_balance_steps + 1, 0.0));
  parallel_for(begin, end, [&](int step) {
    const float u = static_cast<float>(step) / k_balance_steps;
    BlobCloud cloud;
    append_parts(u, 1, cloud);
    std::vector<double> wanted(first.size());
    const double on_the_way = away_from(u) * away_to(u);
    for (size_t i = 0; i < wanted.size(); ++i) {
      const double between = lerp(first[i], last[i], double(u));
      wanted[i] = std::min(between, lerp(between, k_most_on_the_way, on_the_way));
    }
    const std::vector<double> factors = balancing_factors(cloud, wanted);
    // Of a part that is two blobs the second one stands at the same place: either would do.
    for (size_t i = 0; i < factors.size(); ++i) logarithms[part_of_blob_[i]][static_cast<size_t>(step)] = std::log(factors[i]);
  });
  for (size_t i = 0; i < parts_.size(); ++i) parts_[i].balance = Spline<double>::catmull_rom(logarithms[i]);
}

void LiquidMorph::find_gains() {
  const VolumeGrid grid(box_, k_volume_cells);
  const double first = grid.volume(from_), last = grid.volume(to_);
  if (first == 0 || last == 0) return; // an end without a surface: nothing to be linear between
  std::vector<double> gains(k_gain_steps + 1, 1.0);
  const auto [begin, end] = free_steps(k_gain_steps);
  parallel_for(begin, end, [&](int i) {
    const float u = static_cast<float>(i) / k_gain_steps;
    BlobCloud cloud;
    append_parts(u, 1, cloud);
    gains[static_cast<size_t>(i)] = grid.gain_for_volume(cloud, lerp(first, last, u));
  });
  gain_ = Spline<double>::catmull_rom(gains); // its rate of change has no steps, or the liquid would jerk
}

float LiquidMorph::gain_at(float progress) const { return gain_ ? static_cast<float>((*gain_)(progress)) : 1; }

} // namespace kelpie
