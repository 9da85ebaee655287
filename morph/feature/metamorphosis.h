#pragma once

#include "base/affine.h"
#include "field/complex/detail.h"
#include "field/distances/box.h"
#include "field/operators/operands.h"
#include "morph/feature/feature_table.h"
#include "morph/feature/feature_weights.h"

namespace kelpie {

/// What becomes of rotations so far apart that they have no unique mean.
enum class RotationRule { unique, nearest };

template <>
struct EnumNames<RotationRule> {
  static constexpr std::array<std::pair<std::string_view, RotationRule>, 2> values{
      {{"unique", RotationRule::unique}, {"nearest", RotationRule::nearest}}};
};

/// What is made of several distances.
enum class MorphFunction {
  linear,     ///< their weighted mean
  space_time, ///< a section of a blend of each two in space and time
};

template <>
struct EnumNames<MorphFunction> {
  static constexpr std::array<std::pair<std::string_view, MorphFunction>, 2> values{
      {{"linear", MorphFunction::linear}, {"space_time", MorphFunction::space_time}}};
};

template <class Mode>
struct Metamorphosis {
  static constexpr std::string_view k_name = "metamorphosis";
  static constexpr std::string_view k_doc =
      R"(Breeds shapes: several objects become one, feature by feature, each as much as is said for it.

    g = sum_i w_i (sum_j v_ij g_j(E_ij E_i^-1 p) + o_i)     g_j the signed distance to object j, positive inside

An object has `elements`: boxes, each around one of its features (a leg, a seat), with a frame E_ij. Those of the same name belong
together. The child's own feature has the frame E_i, the mean of those of the objects: places and sizes linearly, rotations by the
intrinsic mean on SO(3). In it each object is seen as if its feature stood there, and their distances are mixed.

v_ij, the `weights` of feature i, are any numbers that are not negative; they are divided by their sum. `frame_weights` do the same
for the frame alone: with `weights` of one object and `frame_weights` of another, that is deformed to fit this. A feature that is
not listed has the objects' own `weight`s. An object without the element is seen there where it stands.

w_i is 1 in element i alone, and shared where elements overlap: w_i ~ max(0, d_i)^p, with d_i the signed distance to the element of the
child, positive inside, and p the `sharpness` (1: eq. 5 of the paper, which has creases at borders). Outside all of them the
nearest lead: w_i ~ |d_i|^-p. So elements need not be placed precisely. With a `margin` there is a background, which leads where
all elements are farther than about half of it: there objects are mixed as they stand. Its weights are those of the feature `background`.

What is mixed are distances, so that nothing vanishes in between: objects are made of `sdf_` kinds, Booleans and warps.

The mean of distances, `linear`, breaks what stands apart: a leg here and a leg there leave nothing halfway. `space_time` lets
matter flow: with time as a fourth dimension, objects are half-cylinders that end at 0 and begin at 1, and the shape between is a
section of their bounded blend. It takes t = v_k / (v_j + v_k) for each two objects, and the mean of these sections by v_j v_k, so that
with two objects it is the blend itself, and each object where its weight is all there is. How much matter flows, a_0, is found for each
two so that halfway they have the mean of their volumes.
Source: Sanchez, Fryazinov, Vilbrandt, Pasko 2013, "Morphological shape generation through user-controlled group metamorphosis";
Pasko, Pasko, Kunii 2004 (space-time blending); methods.md section 3; Moakher 2002 (means of rotations).)";

  std::vector<MorphObject<Mode>> objects;
  std::vector<MorphFeature<Mode>> features;
  double sharpness = 2;
  double margin = 0;
  RotationRule rotation = RotationRule::unique;
  MorphFunction function = MorphFunction::linear;
  double displacement = 0;
  double passage = 3;
  double time_influence = 1;

  // Sampled; `prepare` lists all features, each with a weight for each object, of which the sum is 1:
  Expansion expansion; ///< the elements of the child: a distance for each feature but the background
  double reach = 1;    ///< that of all distances below; open_distances() says it

  static constexpr auto parameters() {
    return std::tuple{
        parameter("objects", &Metamorphosis::objects, "the parents").of_at_least(2).required().such_as(k_object_examples),
        parameter("features", &Metamorphosis::features, "how much of each parent each feature has, where not as much as the whole"),
        parameter("sharpness", &Metamorphosis::sharpness, "p: how abruptly one feature leads instead of another").at_least(1).at_most(16),
        parameter("margin", &Metamorphosis::margin,
                  "how far outside all elements the background leads; 0: there is none, unless no "
                  "object has an element")
            .in(Unit::length)
            .at_least(0),
        parameter("rotation", &Metamorphosis::rotation,
                  "of frames too far apart for one mean (all within 90 degrees of it): `unique` is an error, `nearest` takes one of them"),
        parameter("function", &Metamorphosis::function, "what is made of the distances: `linear`: their mean; `space_time`: matter flows"),
        parameter("displacement", &Metamorphosis::displacement,
                  "of a space-time blend, a_0: how much matter flows between two objects; 0: what makes volumes even")
            .at_least(0),
        parameter("passage", &Metamorphosis::passage,
                  "of a space-time blend: how long the objects themselves stay, before and after, in the time in which neither is there")
            .above(0)
            .at_most(100),
        parameter("time_influence", &Metamorphosis::time_influence, "of a space-time blend, a_3: how far matter flows in time").above(0),
    };
  }

  std::optional<ParameterProblem> problem() const {
    if constexpr (std::is_same_v<Mode, AnimatedMode>) return problem_of_features(objects, features, rotation == RotationRule::unique);
    return {};
  }

  // Sampled:

  /// Below it each reference to a part has nodes of its own, as all distances get one reach.
  static constexpr bool k_owns_parts = true;

  void prepare() { complete_features(objects, features, margin > 0); }

  space_time::Settings settings(size_t j, size_t k) const {
    return {{objects[j].influence, objects[k].influence, time_influence}, passage};
  }
  /// Calls visit(j, k, which) for each two objects, j < k, with their place in MorphFeature::blends.
  template <class Visit>
  void for_each_pair(Visit&& visit) const {
    size_t which = 0;
    for (size_t j = 0; j < objects.size(); ++j)
      for (size_t k = j + 1; k < objects.size(); ++k) visit(j, k, which++);
  }

  /// How many features have an element: all but the background, which is the last.
  size_t element_count() const { return features.size() - (has_background() ? 1 : 0); }

  /// The child's elements.
  template <class Emit>
  void for_each_piece(const Divisions&, Emit&& emit) const {
    for (size_t i = 0; i < element_count(); ++i) emit(mean_element(objects, features[i], float(reach)));
  }

  /// The elements, then all objects as each feature sees them.
  template <class Visit>
  void for_each_operand(Visit&& visit) const {
    for (uint32_t i = 0; i < expansion.count; ++i) visit(Operand{expansion.first + i, Role::region, {}});
    for (const MorphFeature<Mode>& feature : features)
      for (const MorphObject<Mode>& object : objects)
        visit(Operand{object.field, Role::child, feature_from_object(objects, feature, object)});
  }

  static constexpr bool k_is_positional = true;
  bool scales_with_threshold(Demand /*mine*/) const { return true; }

  double combine(std::span<const double> f, double threshold, Demand /*mine*/) const { return mixed(f, threshold, Still{*this}); }
  Interval combine(std::span<const Interval> f, double threshold, Demand /*mine*/) const { return mixed(f, threshold, Still{*this}); }
  template <class T, int N>
  Dual<T, N> combine(std::span<const Dual<T, N>> f, double threshold, Demand /*mine*/) const {
    return mixed(f, threshold, Still{*this});
  }
  /// Bounds what the states on the way to another make. (A mean of distances is within those of both ends, a blend is not.)
  Interval combine_until(const Metamorphosis& end, std::span<const Interval> f, double threshold, Demand mine) const {
    if (function == MorphFunction::linear) return hull(combine(f, threshold, mine), end.combine(f, threshold, mine));
    return mixed(f, threshold, Between{*this, end});
  }

  /// Inside a feature those count in which the place may be, and of the objects those that have a weight.
  void keep(std::span<const Interval> f, double threshold, Demand /*mine*/, std::span<char> kept) const {
    thread_local std::vector<Interval> distances;
    find_distances(f, threshold, distances);
    const bool is_in_any = feature_weights::Where(distances).surely > 0;
    for (size_t i = 0; i < features.size(); ++i) {
      const bool counts = !is_in_any || distances[i].hi > 0;
      if (i < element_count()) kept[i] = counts && features.size() > 1;
      for (size_t j = 0; j < objects.size(); ++j) kept[operand(i, j)] = counts && features[i].weights[j] > 0;
      if (i < element_count() && features[i].offset != 0) kept[i] = counts;
    }
  }
  Demand demand_of_operands(Demand /*mine*/, size_t /*count*/) const { return Demand::value; }

  /// Materials are mixed as the distances are.
  void shares(std::span<const double> f, double threshold, std::span<double> shares) const {
    std::vector<double> distances, weights;
    find_distances(f, threshold, distances);
    feature_weights::normalised(distances, sharpness, weights);
    std::fill(shares.begin(), shares.end(), 0.0);
    for (size_t i = 0; i < features.size(); ++i) add_shares(i, f, threshold, weights[i], shares);
  }

private:
  bool has_background() const { return !features.empty() && features.back().name == k_background; }
  size_t operand(size_t feature, size_t object) const { return element_count() + feature * objects.size() + object; }

  // A distance g has the potential T (1 + g / reach).

  /// The numbers of one state.
  struct Still {
    const Metamorphosis& state;
    double weight(size_t feature, size_t object) const { return double(state.features[feature].weights[object]); }
    double offset(size_t feature) const { return double(state.features[feature].offset); }
  };
  /// Those of all states between two.
  struct Between {
    const Metamorphosis &start, &end;
    Interval weight(size_t i, size_t j) const { return hull(Still{start}.weight(i, j), Still{end}.weight(i, j)); }
    Interval offset(size_t i) const { return hull(Still{start}.offset(i), Still{end}.offset(i)); }
  };

  template <class Real, class Numbers>
  Real mixed(std::span<const Real> f, double threshold, const Numbers& numbers) const {
    thread_local std::vector<Real> distances, values;
    find_distances(f, threshold, distances);
    values.clear();
    for (size_t i = 0; i < features.size(); ++i) values.push_back(value_of(i, f, threshold, distances[i], numbers));
    return feature_weights::mean(std::span<const Real>(distances), std::span<const Real>(values), sharpness);
  }

  /// Of all features, positive inside, in reaches. The background begins where all others end.
  template <class Real>
  void find_distances(std::span<const Real> f, double threshold, std::vector<Real>& out) const {
    out.clear();
    for (size_t i = 0; i < element_count(); ++i) out.push_back(f[i] * (1 / threshold) - Real(1.0));
    if (!has_background()) return;
    Real nearest = out.empty() ? Real(-1.0) : out[0];
    for (const Real& d : out) nearest = max(nearest, d);
    out.push_back(Real(0.0) - nearest - Real(margin / reach));
  }

  /// The potential of what feature i makes of the objects. An offset fades with the distance from the element, and where nothing is.
  template <class Real, class Numbers>
  Real value_of(size_t i, std::span<const Real> f, double threshold, const Real& distance, const Numbers& numbers) const {
    const Real g = function == MorphFunction::linear ? mean_of(i, f, numbers) : blend_of(i, f, threshold, numbers);
    const auto offset = numbers.offset(i);
    if (range_of(offset).magnitude() == 0) return g;
    const Real near = clamp(Real(1.0) + distance * (reach / features[i].fade_length()), 0, 1), there = clamp(g * (1 / threshold), 0, 1);
    return g + near * there * Real(offset * (threshold / reach));
  }

  template <class Real, class Numbers>
  Real mean_of(size_t i, std::span<const Real> f, const Numbers& numbers) const {
    Real g(0.0);
    for (size_t j = 0; j < objects.size(); ++j)
      if (const auto weight = numbers.weight(i, j); range_of(weight).hi > 0) g = g + f[operand(i, j)] * weight;
    return g;
  }

  /// The mean of the sections between each two objects, by the products of their weights.
  template <class Real, class Numbers>
  Real blend_of(size_t i, std::span<const Real> f, double threshold, const Numbers& numbers) const {
    using Number = decltype(numbers.weight(0, 0));
    thread_local std::vector<Real> sections;
    thread_local std::vector<Number> products;
    sections.clear(), products.clear();
    for_each_pair([&](size_t j, size_t k, size_t which) {
      const Number v = numbers.weight(i, j), w = numbers.weight(i, k);
      if (range_of(v).hi <= 0 || range_of(w).hi <= 0) return;
      sections.push_back(space_time::section(distance_of(f[operand(i, j)], threshold), distance_of(f[operand(i, k)], threshold),
                                             space_time::part_of_way(v, w), features[i].blends[which], settings(j, k)));
      products.push_back(v * w);
    });
    if (sections.empty())
      for (size_t j = 0; j < objects.size(); ++j)
        if (range_of(numbers.weight(i, j)).hi > 0) return f[operand(i, j)];
    // A potential is never negative.
    const Real g = space_time::mean(std::span<const Number>(products), std::span<const Real>(sections));
    return max(Real(0.0), Real(threshold) + g * (threshold / reach));
  }

  /// Positive inside.
  template <class Real>
  Real distance_of(const Real& potential, double threshold) const {
    return (potential * (1 / threshold) - Real(1.0)) * reach;
  }

  /// The shares of the objects in feature i, `whole` in all.
  void add_shares(size_t i, std::span<const double> f, double threshold, double whole, std::span<double> shares) const {
    const auto& weights = features[i].weights;
    if (function == MorphFunction::linear || std::count_if(weights.begin(), weights.end(), [](float w) { return w > 0; }) < 2) {
      for (size_t j = 0; j < objects.size(); ++j) shares[operand(i, j)] = whole * double(weights[j]);
      return;
    }
    double sum = 0;
    for_each_pair([&](size_t j, size_t k, size_t) { sum += double(weights[j]) * double(weights[k]); });
    for_each_pair([&](size_t j, size_t k, size_t which) {
      const double v = double(weights[j]), w = double(weights[k]), part = whole * v * w / sum;
      if (part == 0) return;
      const size_t a = operand(i, j), b = operand(i, k);
      const double own = space_time::share_of_source(distance_of(f[a], threshold), distance_of(f[b], threshold),
                                                     space_time::part_of_way(v, w), features[i].blends[which], settings(j, k));
      shares[a] += part * own, shares[b] += part * (1 - own);
    });
  }
};

} // namespace kelpie
