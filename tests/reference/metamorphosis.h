// Feature-based metamorphosis, straight from methods.md section 3.
#pragma once

#include <string>
#include <vector>

#include "tests/reference/vec.h"

namespace reference {

/// A box and its frame: edges `size` across, along `axis`, and perpendicular to both.
struct Element {
  std::string name;
  Vec centre, size, axis, across;
  double rounding = 0;
};

/// Of two objects: a unit of length and a_0.
struct Flow {
  double unit = 1, displacement = 0;
};

struct MixFeature {
  std::string name;
  std::vector<double> weights, frame_weights; ///< of each object, not normalised
  double offset = 0, fade = 1;
  bool is_background = false;
  std::vector<Flow> flows; ///< of objects (0, 1), (0, 2) … (1, 2) …
};

struct Mix {
  std::vector<std::vector<Element>> objects; ///< the elements of each
  std::vector<MixFeature> features;          ///< the background is the last
  double sharpness = 2, margin = 0, reach = 1;
  bool is_space_time = false;
  double passage = 3, time_influence = 1;
  std::vector<double> influences; ///< of each object
};

/// The element of the child.
Element mean_element(const Mix&, const MixFeature&);

/// Where a feature looks at an object: x -> E_ij E_i^-1 x.
Affine object_from_child(const Mix&, const MixFeature&, size_t object);

/// The potential, given those of the child's elements and then, feature by feature, those of all objects.
double mixed(const Mix&, const std::vector<double>& f, double threshold);

/// How much each object is of feature i, by the distances to them.
std::vector<double> object_shares(const Mix&, size_t i, const std::vector<double>& distances);

/// The weight of each feature, given the distances to all that have elements, positive inside, in reaches.
std::vector<double> feature_weights(const Mix&, std::vector<double> distances);

} // namespace reference
