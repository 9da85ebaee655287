#include "scene/check_scene.h"

#include <algorithm>
#include <set>
#include <unordered_map>

#include <fmt/format.h>

#include "morph/field_fold.h"

namespace kelpie {

void check_names(const Document& document, ProblemList& problems) {
  const JsonValue* shapes = document.root.find("shapes");
  if (!shapes || !shapes->array()) return;
  std::unordered_map<std::string_view, TextPosition> names;
  for (const JsonValue& shape : *shapes->array()) {
    const JsonValue* name = shape.find("name");
    if (!name || !name->string()) continue;
    const auto [first, is_new] = names.try_emplace(*name->string(), name->at);
    if (!is_new)
      problems.add(document.where(name->at), fmt::format("two shapes are called {} (the other: {})", in_quotes(*name->string()),
                                                         to_string(document.where(first->second))));
  }
}

namespace {

/// The place of the first of the keys that is there, else that of the whole object.
SourcePosition place(const Document& document, std::string_view object, std::initializer_list<std::string_view> keys) {
  const JsonValue* v = document.root.find(object);
  if (!v) return document.where(document.root.at);
  for (const std::string_view key : keys)
    if (const JsonValue* member = v->find(key)) return document.where(member->at);
  return document.where(v->at);
}

void check_frames(const Frames& frames, const Document& document, ProblemList& problems) {
  if (frames.last < frames.first)
    problems.add(place(document, "frames", {"last", "first"}),
                 fmt::format("last must be >= first, found {} and {}", frames.last, frames.first));
}

void check_camera(const Camera<AnimatedMode>& camera, const Document& document, ProblemList& problems) {
  std::set<double> frames;
  for (const Animated<Vec3>* curve : {&camera.position, &camera.look_at, &camera.up})
    for (const double frame : curve->frames()) frames.insert(frame);
  if (frames.empty()) frames.insert(0);
  const SourcePosition where = place(document, "camera", {"look_at", "position", "up"});
  for (const double frame : frames) {
    const Vec3d view = Vec3d(camera.look_at.at(frame)) - Vec3d(camera.position.at(frame)), up(camera.up.at(frame));
    const std::string when = frames.size() > 1 ? fmt::format(" at frame {}", frame) : "";
    if (!(glm::length(view) > 0)) return problems.add(where, "look_at must differ from position" + when);
    // Below this the picture's horizon is noise.
    constexpr double k_sine = 1e-6;
    if (!(glm::length(glm::cross(view, up)) > k_sine * glm::length(view) * glm::length(up)))
      return problems.add(where, "up is parallel to the direction of view" + when);
  }
}

/// Of what `leaves` make the children of an operator endless, the one that makes its own field so; null for a field with an end.
const FieldNode* endless_leaf(ExtentOf extent, std::span<const FieldNode* const> leaves) {
  const auto first = std::find_if(leaves.begin(), leaves.end(), [](const FieldNode* leaf) { return leaf; });
  if (first == leaves.end()) return nullptr;
  if (extent == ExtentOf::first_child) return leaves.front();
  if (extent == ExtentOf::all_children && std::find(leaves.begin(), leaves.end(), nullptr) != leaves.end()) return nullptr;
  return *first;
}

/// A leaf that makes the field below a node endless, given those below its edges; null if there is none.
template <class Kind>
const FieldNode* endless_leaf(const FieldNode& node, const Kind& kind, std::span<const FieldNode* const> below) {
  if constexpr (requires { Kind::k_is_unbounded; }) return &node;
  std::vector<const FieldNode*> leaves; // of children
  for_each_edge(kind, [&, next = below.begin()](const auto&, const ParameterRules& rules) mutable {
    if (const FieldNode* leaf = *next++; rules.role == Role::child) leaves.push_back(leaf);
  });
  return endless_leaf(extent_of<Kind>(), leaves);
}

void check_ends(const Scene& scene, ProblemList& problems) {
  FieldFold<const FieldNode*> endless(PartsShared::always);
  const auto visit = [](const FieldNode& node, const auto& kind, const TimeMap&, std::span<const FieldNode* const> below) {
    return endless_leaf(node, kind, below);
  };
  for (const Shape& shape : scene.shapes)
    if (const FieldNode* leaf = shape.field ? endless(*shape.field, visit) : nullptr)
      problems.add(leaf->where, fmt::format("shape {} has no end: intersect the {} with something that has one", in_quotes(shape.name),
                                            std::visit([](const auto& kind) { return kind.k_name; }, leaf->kind)));
}

/// A skeleton whose `surface_radius` is given must be above the threshold of every shape that it is in, at all keys of both.
template <class Kind>
void check_surface_radius(const FieldNode& node, const Kind& kind, const TimeMap& time, const Shape& shape, double first_frame,
                          ProblemList& problems) {
  if constexpr (requires { kind.surface_radius; }) {
    if (!kind.surface_radius) return;
    std::set<double> frames{first_frame};
    for (const double frame : kind.weight.frames()) frames.insert(time.frame_of(frame));
    for (const double frame : shape.threshold.frames()) frames.insert(frame);
    for (const double frame : frames) {
      const float weight = kind.weight.at(time.at(frame)), threshold = shape.threshold.at(frame);
      if (weight > threshold) continue;
      return problems.add(node.where, fmt::format("surface_radius: the weight must be above the threshold; at frame {} this {} has {}, and "
                                                  "shape {} has {}",
                                                  frame, kind.k_name, weight, in_quotes(shape.name), threshold));
    }
  }
}

void check_surface_radii(const Scene& scene, ProblemList& problems) {
  for (const Shape& shape : scene.shapes) {
    if (!shape.field) continue;
    FieldFold<std::monostate> fold(PartsShared::in_one_time);
    fold(*shape.field, [&](const FieldNode& node, const auto& kind, const TimeMap& time, auto&&) {
      check_surface_radius(node, kind, time, shape, scene.frames.first, problems);
      return std::monostate{};
    });
  }
}

} // namespace

void check_scene(const Scene& scene, const Document& document, ProblemList& problems) {
  check_frames(scene.frames, document, problems);
  check_camera(scene.camera, document, problems);
  check_ends(scene, problems);
  check_surface_radii(scene, problems);
}

} // namespace kelpie
