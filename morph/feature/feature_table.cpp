#include "morph/feature/feature_table.h"

#include <algorithm>
#include <numbers>
#include <numeric>
#include <set>

#include <fmt/format.h>

#include "base/suggest.h"
#include "morph/feature/rotation_mean.h"

namespace kelpie {

namespace {

template <class Mode>
using Objects = std::vector<MorphObject<Mode>>;
using AnimatedFeature = MorphFeature<AnimatedMode>;
using AnimatedObjects = Objects<AnimatedMode>;

/// The features that elements name, each once, in the order in which they come.
template <class Mode>
std::vector<std::string> names_of_elements(const Objects<Mode>& objects) {
  std::vector<std::string> names;
  for (const auto& object : objects)
    for (const auto& element : object.elements)
      if (std::find(names.begin(), names.end(), element.name) == names.end()) names.push_back(element.name);
  return names;
}

/// Scales what is not negative so that its sum is 1; equal parts if all is 0.
void normalise(std::vector<float>& weights) {
  const double sum = std::accumulate(weights.begin(), weights.end(), 0.0);
  for (float& w : weights) w = sum > 0 ? static_cast<float>(double(w) / sum) : 1.f / float(weights.size());
}

/// The orthonormal axes of an element: across, along its axis, and perpendicular to both.
Mat3d axes_of(const Vec3& axis, const Vec3& across) {
  const AxisFrame frame{Vec3d(0), Vec3d(axis), Vec3d(across)};
  return {frame.u, frame.e, glm::cross(frame.u, frame.e)};
}

/// Of the objects that have the element: theirs, and how much they count.
struct Elements {
  std::vector<const FeatureElement<SampledMode>*> list;
  std::vector<double> weights;

  Elements(const SampledObjects& objects, const SampledFeature& feature) {
    for (size_t j = 0; j < objects.size(); ++j)
      if (const auto* element = objects[j].element(feature.name))
        list.push_back(element), weights.push_back(double(feature.frame_weights[j]));
  }
  template <class Member>
  auto mean(Member member) const {
    auto sum = 0.0 * weights[0] * widened(list[0]->*member);
    for (size_t i = 0; i < list.size(); ++i) sum += weights[i] * widened(list[i]->*member);
    return sum;
  }
  bool all_that_count_are(const FeatureElement<SampledMode>& one) const {
    for (size_t i = 0; i < list.size(); ++i)
      if (weights[i] > 0 && *list[i] != one) return false;
    return true;
  }
  Mat3d rotation() const {
    std::vector<Mat3d> rotations;
    for (const auto* e : list) rotations.push_back(axes_of(e->axis, e->across));
    return mean_rotation(rotations, weights).mean;
  }

private:
  static Vec3d widened(const Vec3& v) { return Vec3d(v); }
  static double widened(float v) { return double(v); }
};

Affine frame(const Vec3d& centre, const Vec3d& size, const Mat3d& axes) {
  return {Mat3d(axes[0] * (0.5 * size.x), axes[1] * (0.5 * size.y), axes[2] * (0.5 * size.z)), centre};
}

} // namespace

void complete_features(const SampledObjects& objects, std::vector<SampledFeature>& features, bool has_background) {
  const auto is_listed = [&](std::string_view name) {
    return std::any_of(features.begin(), features.end(), [&](const SampledFeature& f) { return f.name == name; });
  };
  const auto add = [&](const std::string& name) {
    if (!is_listed(name)) features.emplace_back().name = name;
  };
  for (const std::string& name : names_of_elements(objects)) add(name);
  const std::string background(k_background);
  if (has_background || features.empty()) add(background);
  std::stable_partition(features.begin(), features.end(), [&](const SampledFeature& f) { return f.name != background; });
  for (SampledFeature& feature : features) {
    feature.weights.resize(objects.size());
    if (std::all_of(feature.weights.begin(), feature.weights.end(), [](float w) { return w == 0; }))
      for (size_t j = 0; j < objects.size(); ++j) feature.weights[j] = objects[j].weight;
    normalise(feature.weights);
    if (feature.frame_weights.size() != objects.size()) feature.frame_weights = feature.weights;
    double thickness = 0;
    for (size_t j = 0; j < objects.size(); ++j)
      if (const auto* element = objects[j].element(feature.name)) {
        const double half = 0.5 * double(std::min({element->size.x, element->size.y, element->size.z}));
        thickness = thickness > 0 ? std::min(thickness, half) : half;
      } else {
        feature.frame_weights[j] = 0;
      }
    if (thickness > 0) { // there is an element; where none of those that have it counts, all do
      if (std::all_of(feature.frame_weights.begin(), feature.frame_weights.end(), [](float w) { return !(w > 0); }))
        for (size_t j = 0; j < objects.size(); ++j) feature.frame_weights[j] = objects[j].element(feature.name) ? 1.f : 0.f;
      normalise(feature.frame_weights);
    }
    if (!(feature.offset_reach > 0)) feature.offset_reach = thickness;
    feature.blends.assign(objects.size() * (objects.size() - 1) / 2, {});
  }
}

Affine frame_of(const FeatureElement<SampledMode>& e) { return frame(Vec3d(e.centre), Vec3d(e.size), axes_of(e.axis, e.across)); }

SdfBox<SampledMode> mean_element(const SampledObjects& objects, const SampledFeature& feature, float reach) {
  const Elements elements(objects, feature);
  const Mat3d axes = elements.rotation();
  SdfBox<SampledMode> box;
  box.centre = Vec3(elements.mean(&FeatureElement<SampledMode>::centre));
  box.size = Vec3(elements.mean(&FeatureElement<SampledMode>::size));
  box.rounding = float(elements.mean(&FeatureElement<SampledMode>::rounding));
  box.across = Vec3(axes[0]), box.axis = Vec3(axes[1]);
  box.radius = reach;
  return box;
}

Affine mean_frame(const SampledObjects& objects, const SampledFeature& feature) {
  const Elements elements(objects, feature);
  return frame(elements.mean(&FeatureElement<SampledMode>::centre), elements.mean(&FeatureElement<SampledMode>::size), elements.rotation());
}

Affine feature_from_object(const SampledObjects& objects, const SampledFeature& feature, const MorphObject<SampledMode>& object) {
  const FeatureElement<SampledMode>* own = object.element(feature.name);
  if (!own) return {};
  const Elements elements(objects, feature);
  if (elements.all_that_count_are(*own)) return {}; // exactly
  return mean_frame(objects, feature) * inverse(frame_of(*own));
}

// --- what may be wrong ---

namespace {

template <class T>
void add_frames(const Animated<T>& curve, std::set<double>& frames) {
  for (const double frame : curve.frames()) frames.insert(frame);
}

bool is_ever_positive(const Animated<float>& curve) {
  std::set<double> frames;
  add_frames(curve, frames);
  if (frames.empty()) frames.insert(0);
  return std::any_of(frames.begin(), frames.end(), [&](double frame) { return curve.at(frame) > 0; });
}

std::string in_quotes(std::string_view name) { return fmt::format("\"{}\"", name); }

std::optional<std::string> problem_of_names(const AnimatedObjects& objects, const std::vector<AnimatedFeature>& features) {
  const std::vector<std::string> names = names_of_elements(objects);
  for (size_t j = 0; j < objects.size(); ++j) {
    std::set<std::string_view> own;
    for (const auto& element : objects[j].elements) {
      if (element.name == k_background) return fmt::format("objects: {} is the feature without an element", in_quotes(k_background));
      if (!own.insert(element.name).second)
        return fmt::format("objects: object {} has two elements called {}", j + 1, in_quotes(element.name));
    }
  }
  for (const std::string& name : names) {
    const bool is_listed = std::any_of(features.begin(), features.end(), [&](const auto& f) { return f.name == name; });
    const auto owners = std::count_if(objects.begin(), objects.end(), [&](const auto& o) { return o.element(name) != nullptr; });
    if (owners > 1 || is_listed) continue;
    std::vector<std::string_view> others;
    for (const std::string& other : names)
      if (other != name) others.push_back(other);
    const std::string_view near = nearest_name(name, others);
    return fmt::format("objects: no other object has an element {}{}; list it in `features` if only one is to have it", in_quotes(name),
                       near.empty() ? "" : fmt::format(" (did you mean {}?)", in_quotes(near)));
  }
  return {};
}

std::optional<std::string> problem_of_weights(const std::vector<Animated<float>>& weights, std::string_view what,
                                              const AnimatedFeature& feature, size_t objects) {
  if (weights.empty()) return {};
  if (weights.size() != objects)
    return fmt::format("features: {} has {} {}, and there are {} objects", in_quotes(feature.name), weights.size(), what, objects);
  std::set<double> frames;
  for (const auto& w : weights) add_frames(w, frames);
  if (frames.empty()) frames.insert(0);
  for (const double frame : frames)
    if (std::none_of(weights.begin(), weights.end(), [&](const auto& w) { return w.at(frame) > 0; }))
      return fmt::format("features: all {} of {} are 0{}", what, in_quotes(feature.name),
                         frames.size() > 1 ? fmt::format(" at frame {}", frame) : "");
  return {};
}

/// Of the elements of one feature, at one frame.
std::optional<std::string> problem_of_rotations(const AnimatedObjects& objects, const AnimatedFeature& feature, double frame) {
  std::vector<Mat3d> rotations;
  std::vector<size_t> numbers;
  for (size_t j = 0; j < objects.size(); ++j) {
    const auto& weights = feature.frame_weights.empty() ? feature.weights : feature.frame_weights;
    const auto* element = objects[j].element(feature.name);
    if (element && is_ever_positive(weights.empty() ? objects[j].weight : weights[j]))
      rotations.push_back(axes_of(element->axis.at(frame), element->across.at(frame))), numbers.push_back(j + 1);
  }
  if (rotations.size() < 2) return {};
  const std::vector<double> equal(rotations.size(), 1.0 / double(rotations.size()));
  if (mean_rotation(rotations, equal).farthest < 0.5 * std::numbers::pi) return {};
  return fmt::format("objects: the elements {} of objects {} are turned too far apart for a mean: give them other axes, or \"rotation\": "
                     "\"nearest\"",
                     in_quotes(feature.name), fmt::join(numbers, ", "));
}

std::optional<std::string> problem_of_frames(const AnimatedObjects& objects, const AnimatedFeature& feature) {
  std::set<double> frames;
  for (const auto& object : objects)
    if (const auto* element = object.element(feature.name)) add_frames(element->axis, frames), add_frames(element->across, frames);
  if (frames.empty()) frames.insert(0);
  for (const double frame : frames)
    if (const auto problem = problem_of_rotations(objects, feature, frame)) return problem;
  return {};
}

} // namespace

std::optional<ParameterProblem> problem_of_features(const AnimatedObjects& objects, const std::vector<AnimatedFeature>& features,
                                                    bool is_unique) {
  if (const auto problem = problem_of_names(objects, features)) return ParameterProblem{"objects", *problem};
  std::vector<std::string> names = names_of_elements(objects);
  std::set<std::string_view> listed;
  for (const AnimatedFeature& feature : features) {
    const auto in_features = [](std::string message) { return ParameterProblem{"features", std::move(message)}; };
    if (!listed.insert(feature.name).second) return in_features(fmt::format("features: {} is listed twice", in_quotes(feature.name)));
    if (feature.name != k_background && std::find(names.begin(), names.end(), feature.name) == names.end()) {
      const std::vector<std::string_view> known(names.begin(), names.end());
      return in_features(fmt::format("features: no object has an element {}{}", in_quotes(feature.name), suggestion(feature.name, known)));
    }
    for (const auto& [weights, what] : {std::pair(&feature.weights, "weights"), std::pair(&feature.frame_weights, "frame_weights")})
      if (const auto problem = problem_of_weights(*weights, what, feature, objects.size())) return in_features(*problem);
  }
  if (!objects.empty() && std::none_of(objects.begin(), objects.end(), [](const auto& o) { return is_ever_positive(o.weight); }))
    return ParameterProblem{"objects", "objects: the weights of all are 0"};
  if (!is_unique) return {};
  for (const std::string& name : names) {
    const auto row = std::find_if(features.begin(), features.end(), [&](const auto& f) { return f.name == name; });
    AnimatedFeature feature;
    feature.name = name;
    if (const auto problem = problem_of_frames(objects, row == features.end() ? feature : *row))
      return ParameterProblem{"objects", *problem};
  }
  return {};
}

} // namespace kelpie
