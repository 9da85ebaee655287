#include "morph/fit_blends.h"

#include <cmath>
#include <numbers>

#include "base/parallel.h"

#include "morph/open_distances.h"

namespace kelpie {

namespace {

/// Places a side of the lattice on which volumes are compared, and how much wider than an element it is.
constexpr int k_side = 16;
constexpr double k_margin = 1.25;
/// Bodies far apart may take any displacement.
constexpr double k_most_displacement = 1000;

/// The potential, at threshold 1, of a node below a metamorphosis: directly, as there is no program of it yet.
double potential_at(const SampledField& field, unsigned node, const Vec3d& p) {
  return std::visit(
      [&]<class Kind>(const Kind& kind) {
        const Point3<double> at{p.x, p.y, p.z};
        if constexpr (SignedDistance<Kind>) {
          return potential(kind, at) * potential_unit(kind, 1.0);
        } else if constexpr (AffineWarp<Kind>) {
          return potential_at(field, kind.child, inverse(kind.parent_from_child())(p));
        } else if constexpr (Warp<Kind>) {
          const Point3<double> below = kind.child_from_parent(at);
          return potential_at(field, kind.child, {below.x, below.y, below.z});
        } else if constexpr (Operator<Kind>) {
          std::vector<double> operands;
          for_each_operand(kind,
                           [&](const Operand& o) { operands.push_back(potential_at(field, o.node, inverse(o.parent_from_operand)(p))); });
          return kind.combine(std::span<const double>(operands), 1.0, Demand::value);
        } else {
          return 0.0; // nothing else is a distance
        }
      },
      field.nodes[node]);
}

/// How much of a lattice's cell is inside, by the distance at its centre.
double covered(double distance, double cell) { return std::clamp(0.5 + distance / cell, 0.0, 1.0); }

/// The blend of two objects halfway, on a lattice.
class Halfway {
public:
  Halfway(const std::vector<double>& a, const std::vector<double>& b, const space_time::Blend& blend,
          const space_time::Settings& settings) {
    const space_time::Time<double> time(0.5, settings);
    for (size_t i = 0; i < a.size(); ++i)
      matter_.push_back(space_time::matter(space_time::Halves<double>(a[i], b[i], time, blend, settings), time, settings));
  }
  /// In cells.
  double volume(const space_time::Blend& blend, double cell) const {
    double sum = 0;
    for (const space_time::Matter<double>& m : matter_) sum += covered(m.distance(blend), cell);
    return sum;
  }

private:
  std::vector<space_time::Matter<double>> matter_;
};

/// The distances to the objects of a metamorphosis as one of its features sees them, on a lattice about the feature.
class Surroundings {
public:
  Surroundings(const SampledField& field, const Metamorphosis<SampledMode>& mix, size_t feature)
      : mix_(mix), feature_(mix.features[feature]) {
    const Affine frame = frame_of(field);
    cell_ = std::cbrt(std::abs(glm::determinant(frame.linear))) * 2 / k_side;
    for (const auto& object : mix.objects) {
      const Affine object_from_lattice = inverse(feature_from_object(mix.objects, feature_, object)) * frame;
      std::vector<double>& own = distances_.emplace_back();
      for (int z = 0; z < k_side; ++z)
        for (int y = 0; y < k_side; ++y)
          for (int x = 0; x < k_side; ++x) {
            const Vec3d p = (Vec3d(x, y, z) + 0.5) * (2.0 / k_side) - 1.0;
            own.push_back((potential_at(field, object.field, object_from_lattice(p)) - 1) * mix.reach);
          }
    }
  }

  space_time::Blend blend(size_t j, size_t k) const {
    space_time::Blend blend;
    const double wanted = 0.5 * (volume(distances_[j]) + volume(distances_[k]));
    blend.unit = std::cbrt(wanted * 0.75 / std::numbers::pi) * cell_;
    if (!(wanted > 0)) blend.unit = cell_ * k_side / 2;
    if (mix_.displacement > 0) return blend.displacement = mix_.displacement, blend;
    if (!(wanted > 0)) return blend;
    const Halfway halfway(distances_[j], distances_[k], blend, mix_.settings(j, k));
    double least = 0, most = k_most_displacement;
    for (int step = 0; step < 40; ++step) {
      blend.displacement = 0.5 * (least + most);
      (halfway.volume(blend, cell_) < wanted ? least : most) = blend.displacement;
    }
    return blend;
  }

private:
  /// From the cube [-1, 1]^3 to the lattice.
  Affine frame_of(const SampledField& field) const {
    if (feature_.name != k_background) {
      const Affine element = mean_frame(mix_.objects, feature_);
      return {element.linear * k_margin, element.offset};
    }
    Box3d box;
    for (const auto& object : mix_.objects) box.extend(object_box(field, object));
    const Vec3d half = box.extent() * (0.5 * k_margin);
    return {Mat3d(half.x, 0, 0, 0, half.y, 0, 0, 0, half.z), box.centre()};
  }
  /// In cells.
  double volume(const std::vector<double>& distances) const {
    double sum = 0;
    for (const double d : distances) sum += covered(d, cell_);
    return sum;
  }
  const Metamorphosis<SampledMode>& mix_;
  const SampledFeature& feature_;
  double cell_;                                ///< its edge, on the average over directions
  std::vector<std::vector<double>> distances_; ///< of each object, positive inside
};

} // namespace

void fit_blends(SampledField& field, size_t node) {
  auto& mix = std::get<Metamorphosis<SampledMode>>(field.nodes[node]);
  if (mix.function == MorphFunction::linear) return;
  parallel_for(size_t{0}, mix.features.size(), [&](size_t i) {
    const Surroundings surroundings(field, mix, i);
    mix.for_each_pair([&](size_t j, size_t k, size_t which) { mix.features[i].blends[which] = surroundings.blend(j, k); });
  });
}

} // namespace kelpie
