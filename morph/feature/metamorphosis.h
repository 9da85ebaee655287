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
Source: Sanchez, Fryazinov, Vilbrandt, Pasko 2013, "Morphological shape generation through user-controlled group metamorphosis";
methods.md section 3; Moakher 2002 (means of rotations).)";

  std::vector<MorphObject<Mode>> objects;
  std::vector<MorphFeature<Mode>> features;
  double sharpness = 2;
  double margin = 0;
  RotationRule rotation = RotationRule::unique;

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

  double combine(std::span<const double> f, double threshold, Demand /*mine*/) const { return mixed(f, threshold); }
  Interval combine(std::span<const Interval> f, double threshold, Demand /*mine*/) const { return mixed(f, threshold); }
  template <class T, int N>
  Dual<T, N> combine(std::span<const Dual<T, N>> f, double threshold, Demand /*mine*/) const {
    return mixed(f, threshold);
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
    for (size_t i = 0; i < features.size(); ++i)
      for (size_t j = 0; j < objects.size(); ++j) shares[operand(i, j)] = weights[i] * double(features[i].weights[j]);
  }

private:
  bool has_background() const { return !features.empty() && features.back().name == k_background; }
  size_t operand(size_t feature, size_t object) const { return element_count() + feature * objects.size() + object; }

  // A distance g has the potential T (1 + g / reach).

  template <class Real>
  Real mixed(std::span<const Real> f, double threshold) const {
    thread_local std::vector<Real> distances, values;
    find_distances(f, threshold, distances);
    values.clear();
    for (size_t i = 0; i < features.size(); ++i) values.push_back(value_of(i, f, threshold, distances[i]));
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
  template <class Real>
  Real value_of(size_t i, std::span<const Real> f, double threshold, const Real& distance) const {
    const MorphFeature<Mode>& feature = features[i];
    Real g(0.0);
    for (size_t j = 0; j < objects.size(); ++j)
      if (feature.weights[j] > 0) g = g + f[operand(i, j)] * double(feature.weights[j]);
    if (feature.offset == 0) return g;
    const Real near = clamp(Real(1.0) + distance * (reach / feature.fade_length()), 0, 1), there = clamp(g * (1 / threshold), 0, 1);
    return g + near * there * (threshold * double(feature.offset) / reach);
  }
};

} // namespace kelpie
