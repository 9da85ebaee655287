#include "morph/liquid/spread.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>

#include "base/interval.h"
#include "base/point_index.h"

namespace kelpie {

namespace {

/// Rounds, and how far a part goes in each, in reaches, where the pressure changes by 1 over a reach.
constexpr int k_rounds = 20;
constexpr double k_stride = 0.4;

/// No step is longer, in reaches: what lies in one place would fly apart.
constexpr double k_longest = 0.1;

/// Parts are spread as lumps, of all in a cell so many reaches wide; what a part makes of it is a mean over the lumps within so many.
constexpr double k_lump = 0.25, k_blur = 0.5;

/// Neighbours are those that may come near on the way: so many reaches away.
constexpr double k_neighbourhood = 1.35;

/// What lies together.
struct Lump {
  Vec3d centre{0};
  double mass = 0, wanted = 0;
};

std::vector<Lump> lumps_of(std::span<const LiquidPart> parts, double reach) {
  std::map<std::array<int64_t, 3>, Lump> cells;
  for (const LiquidPart& part : parts) {
    const Vec3d cell = glm::floor(part.centre / (k_lump * reach));
    Lump& lump = cells[{int64_t(cell.x), int64_t(cell.y), int64_t(cell.z)}];
    lump.mass += part.mass, lump.centre += part.mass * part.centre, lump.wanted += part.mass * part.wanted;
  }
  std::vector<Lump> lumps;
  for (const auto& [cell, lump] : cells) lumps.push_back({lump.centre / lump.mass, lump.mass, lump.wanted / lump.mass});
  return lumps;
}

double mean_reach(std::span<const LiquidPart> parts) {
  double reach = 0;
  for (const LiquidPart& part : parts) reach += part.radius / double(parts.size());
  return reach;
}

/// Points that are found by their places, in ascending order: sums over them do not depend on how they are found.
class Places {
public:
  explicit Places(std::vector<Vec3d> places) : places_(std::move(places)), index_(places_) {}
  Places(const Places&) = delete; // the index refers to the places

  void find(const Vec3d& p, double within, std::vector<uint32_t>& out) const {
    const auto first = static_cast<std::ptrdiff_t>(out.size());
    index_.visit_within(p, within, [&](size_t i, double) { out.push_back(static_cast<uint32_t>(i)); });
    std::sort(out.begin() + first, out.end());
  }
  const Vec3d& operator[](size_t i) const { return places_[i]; }

private:
  std::vector<Vec3d> places_;
  PointIndex<Vec3d> index_;
};

Places places_of(std::span<const Lump> lumps) {
  std::vector<Vec3d> places;
  for (const Lump& lump : lumps) places.push_back(lump.centre);
  return Places(std::move(places));
}

/// q^2 with q = 1 - |d|^2, of what is d reaches away, for each mass in a cube of a reach.
double falloff_at(const Vec3d& d) { return square(std::max(0.0, 1 - glm::dot(d, d))); }

class Spreader {
public:
  Spreader(std::span<const Lump> lumps, double reach) : lumps_(lumps.begin(), lumps.end()), reach_(reach), first_{0} {
    const Places places = places_of(lumps);
    for (const Lump& lump : lumps_) {
      places.find(lump.centre, k_neighbourhood * reach_, neighbours_);
      first_.push_back(neighbours_.size());
    }
    pressures_.resize(lumps.size()), densities_.resize(lumps.size());
  }

  /// Where the lumps go.
  std::vector<Vec3d> run() {
    std::vector<Vec3d> steps(lumps_.size());
    for (int round = 0; round < k_rounds; ++round) {
      for (size_t i = 0; i < lumps_.size(); ++i) {
        densities_[i] = density_at(i);
        pressures_[i] = std::max(0.0, densities_[i] / lumps_[i].wanted - 1);
      }
      for (size_t i = 0; i < lumps_.size(); ++i) steps[i] = step_of(i);
      for (size_t i = 0; i < lumps_.size(); ++i) lumps_[i].centre += steps[i];
    }
    std::vector<Vec3d> out;
    for (const Lump& lump : lumps_) out.push_back(lump.centre);
    return out;
  }

private:
  template <class Visit>
  void visit_neighbours(size_t i, Visit&& visit) const {
    for (size_t k = first_[i]; k < first_[i + 1]; ++k) {
      const Lump& other = lumps_[neighbours_[k]];
      const Vec3d d = (lumps_[i].centre - other.centre) / reach_;
      if (const double q = 1 - glm::dot(d, d); q > 0) visit(neighbours_[k], d, q, other.mass / (reach_ * reach_ * reach_));
    }
  }

  double density_at(size_t i) const {
    double sum = 0;
    visit_neighbours(i, [&](uint32_t, const Vec3d&, double q, double mass) { sum += mass * q * q; });
    return sum;
  }

  Vec3d step_of(size_t i) const {
    double weights = 0;
    Vec3d push(0), mean(0);
    Mat3d spread(0.0);
    visit_neighbours(i, [&](uint32_t j, const Vec3d& d, double q, double mass) {
      const double weight = mass * q;
      push += (2 * weight * (pressures_[i] + pressures_[j]) / densities_[j]) * d;
      weights += weight, mean += weight * d, spread += glm::outerProduct(d, weight * d);
    });
    mean /= weights;
    spread = spread / weights - glm::outerProduct(mean, mean);
    const double size = spread[0][0] + spread[1][1] + spread[2][2];
    if (!(size > 0)) return Vec3d(0); // it is alone
    const Vec3d step = (k_stride / size) * (spread * push);
    const double length = glm::length(step);
    return reach_ * (length > k_longest ? step * (k_longest / length) : step);
  }

  std::vector<Lump> lumps_;
  double reach_;
  std::vector<double> pressures_, densities_;
  std::vector<uint32_t> neighbours_;
  std::vector<size_t> first_; ///< into these, for each lump; and their count
};

} // namespace

std::vector<double> densities(std::span<const LiquidPart> parts) {
  const double reach = mean_reach(parts);
  const std::vector<Lump> lumps = lumps_of(parts, reach);
  const Places places = places_of(lumps);
  std::vector<double> out;
  std::vector<uint32_t> near;
  for (const LiquidPart& part : parts) {
    near.clear(), places.find(part.centre, reach, near);
    double sum = 0;
    for (const uint32_t i : near) sum += lumps[i].mass / (reach * reach * reach) * falloff_at((part.centre - places[i]) / reach);
    out.push_back(sum);
  }
  return out;
}

std::vector<Vec3d> spread(std::span<const LiquidPart> parts) {
  const double reach = mean_reach(parts);
  const std::vector<Lump> lumps = lumps_of(parts, reach);
  if (lumps.empty()) return {};
  const std::vector<Vec3d> gone = Spreader(lumps, reach).run();
  const Places places = places_of(lumps);
  std::vector<Vec3d> out;
  std::vector<uint32_t> near;
  for (const LiquidPart& part : parts) {
    near.clear(), places.find(part.centre, k_blur * reach, near);
    Vec3d sum(0);
    double weights = 0;
    for (const uint32_t i : near) {
      const double weight = lumps[i].mass * falloff_at((part.centre - places[i]) / (k_blur * reach));
      sum += weight * (gone[i] - places[i]), weights += weight;
    }
    out.push_back(weights > 0 ? part.centre + sum / weights : part.centre);
  }
  return out;
}

} // namespace kelpie
