// Kinds with random parameters, drawn from the ranges of their own tables.
#pragma once

#include <algorithm>
#include <random>
#include <string_view>

#include "colour/colour.h"
#include "morph/field_node.h"

namespace kelpie {

/// The seed is the trial's number, so a failure names what reproduces it.
class Random {
public:
  explicit Random(unsigned trial) : engine_(trial) {}

  double uniform(double lower, double upper) { return std::uniform_real_distribution<>(lower, upper)(engine_); }
  int below(int n) { return std::uniform_int_distribution<>(0, n - 1)(engine_); }
  /// Over orders of magnitude.
  double log_uniform(double lower, double upper) { return std::exp(uniform(std::log(lower), std::log(upper))); }
  Vec3d in(const Box3d& b) { return {uniform(b.lower.x, b.upper.x), uniform(b.lower.y, b.upper.y), uniform(b.lower.z, b.upper.z)}; }
  Vec3d direction() {
    for (;;) {
      const Vec3d v = in({Vec3d(-1), Vec3d(1)});
      const double length = glm::length(v);
      if (length > 0.1 && length < 1) return v / length;
    }
  }

  /// A value that `range` allows, of moderate size.
  double in(const Range& range, double reach = 2) {
    if (range.without_zero) return uniform(0.05 * reach, reach);
    double lower = std::max(range.lower, -reach), upper = std::min(range.upper, reach);
    if (!(lower < upper)) lower = range.lower, upper = std::isfinite(range.upper) ? range.upper : range.lower + reach;
    const double margin = 0.05 * (upper - lower); // off the open ends
    return uniform(lower + (range.lower_open ? margin : 0), upper - (range.upper_open ? margin : 0));
  }

private:
  std::mt19937_64 engine_;
};

inline BlobCloud random_cloud(Random& r, int count, double lowest_weight) {
  BlobCloud cloud(count);
  for (Blob& b : cloud)
    b = {Vec3(r.in(Box3d{Vec3d(-1), Vec3d(1)})), float(r.uniform(0.2, 0.8)), float(r.uniform(lowest_weight, 2)), Falloff(r.below(3))};
  return cloud;
}

/// Of a few lumpy solids.
inline std::shared_ptr<const DistanceGrid> random_distance_grid(Random& r) {
  static const std::array<std::shared_ptr<const DistanceGrid>, 3> k_grids = [] {
    std::array<std::shared_ptr<const DistanceGrid>, 3> grids;
    for (size_t i = 0; i < grids.size(); ++i) {
      const double lump = 0.06 * double(i), voxel = 0.07 + 0.03 * double(i);
      const auto distance = [=](const Vec3d& p, double) {
        return glm::length(p - 0.1) - 0.5 + lump * std::sin(9 * p.x) * std::cos(8 * p.y + 5 * p.z);
      };
      grids[i] = std::make_shared<const DistanceGrid>(Box3d{Vec3d(-0.8), Vec3d(0.9)}, voxel, 0.25, distance);
    }
    return grids;
  }();
  return k_grids[size_t(r.below(int(k_grids.size())))];
}

/// Draws one parameter. Files, names and children are left as they are.
template <class T>
void randomise(T& member, const ParameterRules& rules, Random& r) {
  const double reach = rules.unit == Unit::degrees ? 180 : 2;
  if constexpr (std::is_same_v<T, bool>)
    member = r.below(2) == 1;
  else if constexpr (std::is_floating_point_v<T>)
    member = static_cast<T>(r.in(rules.range, reach));
  else if constexpr (std::is_integral_v<T> && !std::is_same_v<T, unsigned>)
    member = static_cast<T>(std::lround(r.in(rules.range)));
  else if constexpr (std::is_enum_v<T>)
    member = EnumNames<T>::values[r.below(static_cast<int>(EnumNames<T>::values.size()))].second;
  else if constexpr (std::is_same_v<T, std::vector<Vec3>> || std::is_same_v<T, std::vector<float>>) {
    member.resize(1 + r.below(8));
    for (auto& element : member) randomise(element, rules, r);
  } else if constexpr (std::is_same_v<T, Vec3>)
    for (int i = 0; i < 3; ++i) {
      // A mirror, along one axis: between two such there is none with a factor of 0.
      const bool is_mirrored = rules.range.without_zero && i == 2;
      member[i] = static_cast<float>(r.in(rules.range, reach) * (is_mirrored ? -1 : 1));
    }
  else if constexpr (std::is_same_v<T, Colour>)
    randomise(member.rgb, rules, r);
}

/// An axis from one side of the origin to the other, about as long where it goes.
inline void randomise(std::vector<AxialAxis<SampledMode>>& axes, const ParameterRules&, Random& r) {
  axes.resize(r.below(4) ? 1 : 1 + r.below(3));
  for (AxialAxis<SampledMode>& axis : axes) {
    const int count = 2 + r.below(5);
    const Vec3 at(r.in(Box3d{Vec3d(-0.7), Vec3d(0.7)})), along(r.direction());
    const float swing = float(r.below(6) ? r.log_uniform(0.05, 0.8) : 0.0);
    for (int i = 0; i < count; ++i) {
      const Vec3 p = at + along * (float(i) / float(count - 1) - 0.5f) * 2.4f;
      axis.rest.push_back(p + 0.2f * Vec3(r.direction()));
      axis.deformed.push_back(p + swing * Vec3(r.direction()));
    }
    axis.degree = r.below(6) ? 2 + r.below(2) : 1, axis.normal = Vec3(r.direction());
    for (int i = r.below(3); i > 0; --i) axis.frames.push_back({float(r.uniform(0, 1)), float(r.uniform(-120, 120))});
    axis.interpolation = FrameInterpolation(r.below(2));
    axis.radius = float(r.uniform(0.3, 1)), axis.border = float(r.uniform(0.1, 1));
  }
}

/// Elements that are turned by no more than half a right angle from one another.
inline void randomise(std::vector<MorphObject<SampledMode>>& objects, const ParameterRules&, Random& r) {
  objects.resize(r.below(4) ? 2 : 3);
  const Vec3d axis = r.direction(), across = r.direction();
  for (const std::string name : {"a", "b"}) {
    const Vec3d at = r.in(Box3d{Vec3d(-0.8), Vec3d(0.8)});
    for (auto& object : objects) {
      if (r.below(6) == 0) continue;
      FeatureElement<SampledMode>& e = object.elements.emplace_back();
      e.name = name, e.centre = Vec3(at + 0.3 * r.direction());
      for (int i = 0; i < 3; ++i) e.size[i] = float(r.uniform(0.3, 1.2));
      const Vec3d y = glm::normalize(axis + 0.3 * r.direction());
      e.axis = Vec3(y), e.across = Vec3(glm::cross(y, across) + 0.2 * r.direction()), e.rounding = float(r.uniform(0, 0.1));
    }
  }
  for (auto& object : objects) object.weight = float(r.uniform(0.1, 2));
}
/// Features go with the objects: add_random_features().
inline void randomise(std::vector<MorphFeature<SampledMode>>&, const ParameterRules&, Random&) {}
/// At times with less of one object, or none of it.
inline void add_random_features(Metamorphosis<SampledMode>& kind, Random& r) {
  for (const std::string name : {"b", "background"}) {
    const bool is_there = std::any_of(kind.objects.begin(), kind.objects.end(), [&](const auto& o) { return o.element(name); });
    if (name == "b" ? !is_there : r.below(3) > 0) continue;
    MorphFeature<SampledMode>& feature = kind.features.emplace_back();
    feature.name = name, feature.offset = float(r.uniform(-0.05, 0.1)), feature.offset_reach = r.uniform(0.05, 0.5);
    for (size_t j = 0; j < kind.objects.size(); ++j) feature.weights.push_back(float(r.below(3) ? r.uniform(0, 1) : 0.0));
    feature.weights[0] += 0.1f;
  }
  kind.reach = 4;
  kind.passage = r.uniform(1, 4), kind.time_influence = r.uniform(0.5, 2);
  for (auto& object : kind.objects) object.influence = r.uniform(0.5, 2);
}

/// A sampled kind with random parameters and, where it has files, random contents.
template <template <class> class Kind>
Kind<SampledMode> random_kind(Random& r) {
  Kind<SampledMode> kind;
  std::apply([&](const auto&... row) { (randomise(kind.*(row.member), row, r), ...); }, Kind<SampledMode>::parameters());
  if constexpr (requires { kind.grid; }) kind.grid = random_distance_grid(r);
  if constexpr (requires { kind.cloud; }) kind.cloud = std::make_shared<const BlobCloud>(random_cloud(r, 1 + r.below(9), -1));
  if constexpr (std::is_same_v<Kind<SampledMode>, Metamorphosis<SampledMode>>) add_random_features(kind, r);
  if constexpr (requires { kind.prepare(); }) kind.prepare();
  if constexpr (std::is_same_v<Kind<SampledMode>, Metamorphosis<SampledMode>>) kind.expansion.count = uint32_t(kind.element_count());
  if constexpr (std::is_same_v<Kind<SampledMode>, Patch<SampledMode>>) {
    kind.points.resize(BezierPatch::k_points * (1 + r.below(2)));
    for (Vec3& p : kind.points) p = Vec3(r.in(Box3d{Vec3d(-1), Vec3d(1)}));
  }
  if constexpr (std::is_same_v<Kind<SampledMode>, Subdivision<SampledMode>>) { // two faces that share an edge
    SubdivisionMesh mesh;
    SubdivisionMesh::Level level;
    for (int i = 0; i < 6; ++i) {
      level.positions.push_back(Vec3(r.in(Box3d{Vec3d(-1), Vec3d(1)}))), level.normals.push_back(Vec3(r.direction()));
      level.thickness.push_back(float(r.uniform(0, 1)));
      mesh.box.extend(Vec3d(level.positions.back()));
    }
    level.faces = {{0, 1, 2, 3}, {1, 4, 5, 2}}, level.borders = {{0, 1}, {1, 4}, {4, 5}, {5, 2}, {2, 3}, {3, 0}};
    mesh.levels = {level};
    kind.mesh = std::make_shared<const SubdivisionMesh>(std::move(mesh));
  }
  if constexpr (requires { kind.morph; }) { // through up to two others
    std::vector<BlobCloud> clouds;
    for (int i = r.below(3) + 2; i > 0; --i) clouds.push_back(random_cloud(r, 1 + r.below(9), 0.5));
    std::vector<const BlobCloud*> row;
    for (const BlobCloud& cloud : clouds) row.push_back(&cloud);
    kind.morph = std::make_shared<const LiquidChain>(row, kind.correspondence, kind.volume, kind.ends);
  }
  return kind;
}

/// Makes lengths moderate and, at times, what is a special case: 0 where that is allowed, two lengths or two
/// places alike, or one place hardly off another.
template <class Kind>
void make_special(Kind& kind, Random& r) {
  const float* last_length = nullptr;
  const Vec3* last_place = nullptr;
  const auto one = [&](auto& member, const ParameterRules& rules) {
    if (rules.unit != Unit::length || rules.name == "radius") return;
    using T = std::decay_t<decltype(member)>;
    const auto length = [&](float& x) {
      x *= 0.4f;
      if (rules.range.contains(0) && r.below(5) == 0) x = 0;
      if (last_length && r.below(8) == 0) x = *last_length;
      last_length = &x;
    };
    if constexpr (std::is_same_v<T, float>) {
      length(member);
    } else if constexpr (std::is_same_v<T, std::vector<Vec3>>) { // in a plane, at times, or some of them alike
      const int flat = r.below(9);
      for (Vec3& p : member) {
        if (flat < 3) p[flat] = member[0][flat];
        if (r.below(8) == 0) p = member[0];
      }
    } else if constexpr (std::is_same_v<T, std::vector<float>>) {
      for (float& x : member) length(x);
    } else if constexpr (std::is_same_v<T, Vec3>) {
      if (rules.range.lower == 0) { // a size
        for (int i = 0; i < 3; ++i) length(member[i]);
        return;
      }
      if (last_place && r.below(8) == 0) member = *last_place + float(r.below(3)) * 0.02f * Vec3(r.direction());
      last_place = &member;
    }
  };
  std::apply([&](const auto&... row) { (one(kind.*(row.member), row), ...); }, Kind::parameters());
}

} // namespace kelpie
