#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "morph/liquid/body_graph.h"
#include "morph/liquid/match.h"

namespace kelpie {

namespace {

/// The blur of the plan, as a squared length in the canonical frame: from coarse, where the iteration converges quickly, to
/// a length of some percent of the shape.
constexpr double k_first_blur = 0.3, k_last_blur = 0.004, k_blur_factor = 0.5;
constexpr int k_sweeps = 12, k_last_sweeps = 60;

/// A factor of two in radius costs as much as this way, squared.
constexpr double k_radius_cost = 0.01;

/// Parts of less than this share of both of their blobs are left out.
constexpr double k_least_share = 0.07;

/// A blob as a point with mass, in the canonical frame.
struct Parcel {
  Vec3d place{0};
  double mass = 0; ///< the sum of all is 1
  double log_radius = 0;
};

/// The blobs of a cloud in its canonical frame.
struct Parcels {
  std::vector<Parcel> all;
  double size = 1; ///< the root of the mean square distance from the centre of mass, in scene units

  explicit Parcels(const BlobCloud& cloud) {
    double total = 0, spread = 0;
    Vec3d sum(0);
    for (const Blob& b : cloud) {
      const double r = b.radius, mass = std::max(std::abs(double(b.weight)), 1e-6) * r * r * r;
      all.push_back({Vec3d(b.centre), mass, std::log2(r)});
      total += mass, sum += mass * Vec3d(b.centre);
    }
    const Vec3d centre = sum / total;
    for (const Parcel& p : all) spread += p.mass * glm::dot(p.place - centre, p.place - centre);
    size = spread > 0 ? std::sqrt(spread / total) : double(cloud[0].radius);
    for (Parcel& p : all) p.place = (p.place - centre) / size, p.mass /= total, p.log_radius -= std::log2(size);
  }
};

/// Sinkhorn's iteration on logarithms: plan_ij = a_i b_j exp((f_i + g_j - cost_ij) / blur).
class Sinkhorn {
public:
  /// squared_way(i, j) in the canonical frame.
  template <class Way>
  Sinkhorn(const std::vector<Parcel>& a, const std::vector<Parcel>& b, Way&& squared_way)
      : a_(a), b_(b), cost_(a.size() * b.size()), f_(a.size(), 0), g_(b.size(), 0) {
    for (size_t i = 0; i < a.size(); ++i)
      for (size_t j = 0; j < b.size(); ++j) {
        const double r = a[i].log_radius - b[j].log_radius;
        cost_[i * b.size() + j] = squared_way(i, j) + k_radius_cost * r * r;
      }
    for (blur_ = k_first_blur;; blur_ = std::max(blur_ * k_blur_factor, k_last_blur)) {
      const bool is_last = blur_ <= k_last_blur;
      for (int sweep = 0; sweep < (is_last ? k_last_sweeps : k_sweeps); ++sweep) {
        // Each entry is its own sum: threads change nothing.
        parallel_for(size_t{0}, b.size(), [&](size_t j) { g_[j] = soft_min(a_, f_, [&](size_t i) { return cost(i, j); }); });
        parallel_for(size_t{0}, a.size(), [&](size_t i) { f_[i] = soft_min(b_, g_, [&](size_t j) { return cost(i, j); }); });
      }
      if (is_last) break;
    }
  }

  double plan(size_t i, size_t j) const { return a_[i].mass * b_[j].mass * std::exp((f_[i] + g_[j] - cost(i, j)) / blur_); }

private:
  double cost(size_t i, size_t j) const { return cost_[i * b_.size() + j]; }

  /// -blur log sum_k m_k exp((h_k - cost_k) / blur)
  template <class Cost>
  double soft_min(const std::vector<Parcel>& parcels, const std::vector<double>& h, Cost&& cost_to) const {
    double most = -1e300;
    for (size_t k = 0; k < parcels.size(); ++k) most = std::max(most, h[k] - cost_to(k));
    double sum = 0;
    for (size_t k = 0; k < parcels.size(); ++k)
      if (const double x = (h[k] - cost_to(k) - most) / blur_; x > -40) sum += parcels[k].mass * std::exp(x);
    return -most - blur_ * std::log(sum);
  }

  const std::vector<Parcel>&a_, &b_;
  std::vector<double> cost_, f_, g_;
  double blur_ = k_first_blur;
};

std::vector<Link> links_of(const Sinkhorn& transport, const std::vector<Parcel>& a, const std::vector<Parcel>& b) {
  std::vector<double> plan(a.size() * b.size()), row_most(a.size(), 0), column_most(b.size(), 0);
  for (size_t i = 0; i < a.size(); ++i)
    for (size_t j = 0; j < b.size(); ++j) {
      const double p = plan[i * b.size() + j] = transport.plan(i, j);
      row_most[i] = std::max(row_most[i], p), column_most[j] = std::max(column_most[j], p);
    }
  std::vector<double> row(a.size(), 0), column(b.size(), 0);
  std::vector<Link> links;
  for (unsigned i = 0; i < a.size(); ++i)
    for (unsigned j = 0; j < b.size(); ++j) {
      const double p = plan[i * b.size() + j];
      const bool is_largest = p >= row_most[i] || p >= column_most[j]; // so that everybody has a partner
      if (!is_largest && p < k_least_share * a[i].mass && p < k_least_share * b[j].mass) continue;
      links.push_back({i, j, 0, 0});
      row[i] += p, column[j] += p;
    }
  for (Link& l : links) {
    const double p = plan[l.from * b.size() + l.to];
    l.from_share = row[l.from] > 0 ? static_cast<float>(p / row[l.from]) : 1;
    l.to_share = column[l.to] > 0 ? static_cast<float>(p / column[l.to]) : 1;
  }
  return links;
}

} // namespace

std::vector<Link> match_transport(const BlobCloud& from, const BlobCloud& to) {
  const Parcels a(from), b(to);
  const auto straight = [&](size_t i, size_t j) {
    const Vec3d d = a.all[i].place - b.all[j].place;
    return glm::dot(d, d);
  };
  return links_of(Sinkhorn(a.all, b.all, straight), a.all, b.all);
}

std::vector<Link> match_transport(const BlobCloud& from, const BlobCloud& to, const BodyGraph& bodies) {
  const Parcels a(from), b(to);
  const double size = 0.5 * (a.size + b.size);
  const auto through = [&](size_t i, size_t j) {
    const double way = bodies.length(i, j) / size;
    return way * way;
  };
  return links_of(Sinkhorn(a.all, b.all, through), a.all, b.all);
}

} // namespace kelpie
