// The objects and features of a metamorphosis: what a scene says of them, and what follows from that at one moment.
#pragma once

#include <string>

#include "base/affine.h"
#include "base/kind.h"
#include "field/distances/box.h"
#include "morph/feature/space_time.h"

namespace kelpie {

/// The feature that leads where no element is near.
inline constexpr std::string_view k_background = "background";

/// What manual pages show.
inline constexpr std::string_view k_object_examples =
    R"([{"field": {"kind": "sdf_sphere", "centre": [0, 0, 0], "sphere_radius": 1}}, {"field": {"kind": "sdf_box", "centre": [0, 0, 0], "size": 1.6}}])";

template <class Mode>
struct FeatureElement {
  static constexpr std::string_view k_name = "feature_element";
  static constexpr std::string_view k_doc =
      "A box around a feature of an object of a `metamorphosis`; its centre, directions and edges are the "
      "feature's frame.";

  std::string name;
  Value<Mode, Vec3> centre{Vec3(0)};
  Value<Mode, Vec3> size{Vec3(1)};
  Value<Mode, Vec3> axis{Vec3(0, 1, 0)};
  Value<Mode, Vec3> across{Vec3(1, 0, 0)};
  Value<Mode, float> rounding{0.f};

  static constexpr auto parameters() {
    using E = FeatureElement;
    return std::tuple{
        parameter("name", &E::name, "of the feature: elements of the same name belong together").required(),
        parameter("centre", &E::centre, "the box's centre").in(Unit::length).required(),
        parameter("size", &E::size, "its edges: across, along its axis, and perpendicular to both; or one number for all")
            .in(Unit::length)
            .above(0)
            .or_number_for_all()
            .required(),
        parameter("axis", &E::axis, "direction of its second edges; need not be a unit vector").nonzero(),
        parameter("across", &E::across, "direction of its first edges; only what is perpendicular to `axis` counts").nonzero(),
        parameter("rounding", &E::rounding, "the radius of its edges").in(Unit::length).at_least(0),
    };
  }
  friend bool operator==(const FeatureElement&, const FeatureElement&) = default;
};

template <class Mode>
struct MorphObject {
  static constexpr std::string_view k_name = "morph_object";
  static constexpr std::string_view k_doc = "A parent of a `metamorphosis`: a shape, and where its features are.";

  std::string name;
  typename Mode::Child field{};
  Value<Mode, float> weight{1.f};
  double influence = 1;
  std::vector<FeatureElement<Mode>> elements;

  static constexpr auto parameters() {
    return std::tuple{
        parameter("name", &MorphObject::name, "what `--set` and recipes call it"),
        parameter("field", &MorphObject::field, "its shape, made of signed distances")
            .required()
            .such_as(R"({"kind": "sdf_sphere", "centre": [0, 0, 0], "sphere_radius": 1})"),
        parameter("weight", &MorphObject::weight, "how much of it the features have that are not listed").at_least(0),
        parameter("influence", &MorphObject::influence, "of a space-time blend, a_1 or a_2: how far the object draws matter to itself")
            .above(0),
        parameter("elements", &MorphObject::elements, "where its features are"),
    };
  }
  friend bool operator==(const MorphObject&, const MorphObject&) = default;

  const FeatureElement<Mode>* element(std::string_view called) const {
    for (const auto& e : elements)
      if (e.name == called) return &e;
    return nullptr;
  }
};

template <class Mode>
struct MorphFeature {
  static constexpr std::string_view k_name = "morph_feature";
  static constexpr std::string_view k_doc = "How much of each object a feature of a `metamorphosis` has.";

  std::string name;
  std::vector<Value<Mode, float>> weights, frame_weights;
  Value<Mode, float> offset{0.f};
  double offset_reach = 0;

  // Sampled: what fits each two objects, (0, 1), (0, 2) … (1, 2) …
  std::vector<space_time::Blend> blends;

  static constexpr auto parameters() {
    using F = MorphFeature;
    return std::tuple{
        parameter("name", &F::name, "which: that of elements, or `background`").required(),
        parameter("weights", &F::weights, "one for each object, not negative; none: the objects' own").at_least(0),
        parameter("frame_weights", &F::frame_weights, "the same for the place, the size and the rotation of the feature; none: its weights")
            .at_least(0),
        parameter("offset", &F::offset, "how much thicker it becomes").in(Unit::length),
        parameter("offset_reach", &F::offset_reach,
                  "how far outside the element that fades to nothing; 0: half the thickness of the element")
            .in(Unit::length)
            .at_least(0),
    };
  }
  friend bool operator==(const MorphFeature&, const MorphFeature&) = default;

  /// Never 0.
  double fade_length() const { return offset_reach > 0 ? offset_reach : 1e-6; }
};

/// What is wrong with the objects and features of a scene; whether rotations must have a unique mean.
std::optional<ParameterProblem> problem_of_features(const std::vector<MorphObject<AnimatedMode>>&,
                                                    const std::vector<MorphFeature<AnimatedMode>>&, bool is_unique);

using SampledObjects = std::vector<MorphObject<SampledMode>>;
using SampledFeature = MorphFeature<SampledMode>;

/// Lists all features, those that the scene lists first, the background last if it is wanted or nothing else is there; gives each a weight
/// and a frame weight for each object, with a sum of 1, the length over which its offset fades, and blends of no particular shapes.
void complete_features(const SampledObjects&, std::vector<SampledFeature>&, bool has_background);

/// The frame of an element: from the cube [-1, 1]^3 to the box.
Affine frame_of(const FeatureElement<SampledMode>&);

/// The element of the child, by the frame weights of a complete feature: its distance, of a reach.
SdfBox<SampledMode> mean_element(const SampledObjects&, const SampledFeature&, float reach);

/// The frame of the child's element, from the cube [-1, 1]^3, by the frame weights of a complete feature that has one.
Affine mean_frame(const SampledObjects&, const SampledFeature&);

/// Where a feature of the child sees an object: E_i E_ij^-1. The identity for the background, and for an object without the element.
Affine feature_from_object(const SampledObjects&, const SampledFeature&, const MorphObject<SampledMode>&);

} // namespace kelpie
