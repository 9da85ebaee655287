#include "scene/check_scene.h"

#include <set>
#include <unordered_map>

#include <fmt/format.h>

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
  std::set<double> frames{0};
  for (const Animated<Vec3>* curve : {&camera.position, &camera.look_at, &camera.up})
    for (const Key<Vec3>& key : curve->keys()) frames.insert(key.frame);
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

/// Finds leaves that make fields endless. Parts are looked at once, however many instances they have.
class EndlessLeaves {
public:
  /// One that makes this field endless; null if there is none.
  const FieldNode* find(const FieldNode& node) {
    const auto known = found_.find(&node);
    if (known != found_.end()) return known->second;
    const FieldNode* leaf = std::visit([&](const auto& kind) { return find_below(node, kind); }, node.kind);
    found_.emplace(&node, leaf);
    return leaf;
  }

private:
  template <class Kind>
  const FieldNode* find_below(const FieldNode& node, const Kind& kind) {
    if constexpr (requires { Kind::k_is_unbounded; }) return &node;
    if constexpr (requires { kind.child; }) return find(*kind.child);
    const FieldNode* first = nullptr;
    if constexpr (requires { kind.children; })
      for (const FieldPtr& child : kind.children) {
        const FieldNode* leaf = find(*child);
        if (extent_of<Kind>() == ExtentOf::first_child) return leaf;
        if (extent_of<Kind>() == ExtentOf::all_children && !leaf) return nullptr;
        if (!first) first = leaf;
      }
    return first;
  }

  std::unordered_map<const FieldNode*, const FieldNode*> found_;
};

void check_ends(const Scene& scene, ProblemList& problems) {
  EndlessLeaves endless;
  for (const Shape& shape : scene.shapes)
    if (const FieldNode* leaf = shape.field ? endless.find(*shape.field) : nullptr)
      problems.add(leaf->where, fmt::format("shape {} has no end: intersect the {} with something that has one", in_quotes(shape.name),
                                            std::visit([](const auto& kind) { return kind.k_name; }, leaf->kind)));
}

} // namespace

void check_scene(const Scene& scene, const Document& document, ProblemList& problems) {
  check_frames(scene.frames, document, problems);
  check_camera(scene.camera, document, problems);
  check_ends(scene, problems);
}

} // namespace kelpie
