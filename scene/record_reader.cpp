#include "scene/record_reader.h"

#include "base/one_of.h"
#include "materials/presets.h"
#include "scene/other_names.h"

namespace kelpie {

template struct OneOf<SceneFieldKinds, AnimatedMode>;

namespace {

constexpr ParameterRules k_material_of_node{"material", {}}, k_name_of_node{"name", {}}, k_named_material{"materials", {}};

/// A scene cannot ask for more at every point of a surface.
constexpr int k_most_materials_deep = 32, k_most_materials_in_one = 1000;

Stop<AnimatedMode> stop_of(const PlainStop& plain, float size) {
  OpenPbr<AnimatedMode> surface;
  surface.base_color = Colour{Vec3(plain.red, plain.green, plain.blue)}, surface.specular_roughness = plain.roughness;
  surface.bump_height = plain.height * size;
  return {plain.at, make_material<OpenPbr>(surface)};
}

std::string unknown_kind(std::string_view group, std::string_view name, std::span<const std::string_view> known) {
  const std::string near = near_names(name, known);
  return fmt::format("unknown kind of {} {}{}", group, in_quotes(name), near.empty() ? suggestion(name, known) : near);
}

} // namespace

std::string unknown_name(std::string_view what, std::string_view name, std::span<const std::string_view> known) {
  const std::string hint = known.empty() ? fmt::format(": the scene has no {}s", what) : suggestion(name, known);
  return fmt::format("unknown {} {}{}", what, in_quotes(name), hint);
}

/// What makes a tree stands for the union of what it makes it of until that tree is there.
template <class Kind>
void RecordReader::set_kind(const FieldPtr& node, Kind&& kind) {
  if constexpr (std::is_same_v<std::decay_t<Kind>, Animorphosis<AnimatedMode>>) {
    node->kind = Union<AnimatedMode>{BooleanFormula::automatic, {kind.from, kind.to}};
    tree_makers_.push_back({node, std::move(kind)});
  } else {
    node->kind = std::move(kind);
  }
}

bool RecordReader::read(FieldPtr& out, const JsonValue& v, const ParameterRules& rules) {
  auto node = std::make_shared<FieldNode>();
  node->where = where(v);
  SceneFieldKinds::Variant<AnimatedMode> kind;
  bool is_good = read(kind, v, rules);
  std::visit([&](auto& k) { set_kind(node, std::move(k)); }, kind);
  if (const JsonValue* material = v.find("material")) is_good &= read(node->material, *material, k_material_of_node);
  if (const JsonValue* name = v.find("name")) is_good &= read(node->name, *name, k_name_of_node);
  nodes_.push_back({node, &v});
  out = std::move(node);
  return is_good;
}

bool RecordReader::read(FreeObject& out, const JsonValue& v, const ParameterRules& rules) {
  if (!v.object()) return fail_type(v, rules.name, "an object");
  out.text = canonical_text(v);
  return true;
}

bool RecordReader::read(MaterialPtr& out, const JsonValue& v, const ParameterRules& rules) {
  return v.string() ? read_material_name(out, v) : read_new_material(out, v, rules);
}

/// A pattern without stops has those of its kind; others ascend, at least at all their keys. What a transition does not say is chosen.
template <class Kind>
bool RecordReader::complete(Kind& kind, const JsonValue& v) {
  if constexpr (std::is_same_v<Kind, Transition<AnimatedMode>>) try {
      complete_transition(kind, frames_to_check().front());
    } catch (const Error& e) {
      return fail(v, e.what());
    }
  if constexpr (requires { kind.stops; }) {
    if (v.find("stops") && kind.stops.empty()) return fail(*v.find("stops"), "stops may not be empty");
    if (kind.stops.empty()) {
      for (const PlainStop& plain : Kind::k_default_stops) kind.stops.push_back(stop_of(plain, kind.size.at(frames_to_check().front())));
      return true;
    }
    std::set<double> frames;
    for (const Stop<AnimatedMode>& stop : kind.stops)
      for (const double frame : stop.at.frames()) frames.insert(frame);
    if (frames.empty()) frames.insert(0);
    const auto are_in_order = [&](double frame) {
      return std::is_sorted(kind.stops.begin(), kind.stops.end(),
                            [&](const auto& a, const auto& b) { return a.at.at(frame) < b.at.at(frame); });
    };
    if (!std::all_of(frames.begin(), frames.end(), are_in_order)) return fail(*v.find("stops"), "stops must ascend");
  }
  return true;
}

bool RecordReader::read_new_material(MaterialPtr& out, const JsonValue& v, const ParameterRules& rules) {
  auto node = std::make_shared<MaterialNode>();
  node->where = where(v);
  if (!read(node->kind, v, rules)) return false;
  if (!std::visit([&](auto& kind) { return complete(kind, v); }, node->kind)) return false;
  const auto count_below = [&]<class T>(const ParameterRules&, const T& value) {
    if constexpr (IsMaterialEdge<T>) node->depth = std::max(node->depth, value->depth + 1), node->count += value->count;
  };
  std::visit([&](auto& kind) { for_each_value(count_below, kind); }, node->kind);
  if (node->depth > k_most_materials_deep) return fail(v, fmt::format("more than {} materials in one another", k_most_materials_deep));
  if (node->count > k_most_materials_in_one) return fail(v, fmt::format("more than {} materials in one", k_most_materials_in_one));
  out = std::move(node);
  return true;
}

MaterialPtr RecordReader::named_material(const std::string& name, const JsonValue& v) {
  const auto [known, is_new] = named_.try_emplace(&v);
  if (!is_new) {
    if (!known->second && being_read_.count(&v)) fail(v, fmt::format("material {} is made of itself", in_quotes(name)));
    return known->second;
  }
  if (being_read_.size() >= size_t(k_most_materials_deep)) {
    fail(v, fmt::format("more than {} materials in one another", k_most_materials_deep));
    return nullptr;
  }
  being_read_.insert(&v);
  MaterialPtr material;
  read(material, v, k_named_material);
  being_read_.erase(&v);
  return named_[&v] = material;
}

bool RecordReader::read_material_name(MaterialPtr& out, const JsonValue& v) {
  out = nullptr;
  const std::string& name = *v.string();
  std::vector<std::string_view> known;
  if (const JsonValue* materials = document().root.find("materials"); materials && materials->object())
    for (const JsonMember& m : *materials->object()) {
      if (m.key == name) return bool(out = named_material(name, m.value));
      known.push_back(m.key);
    }
  if (const Preset* preset = find_preset(name)) {
    out = make_material<OpenPbr>(preset->surface<AnimatedMode>());
    return true;
  }
  PlainMaterialKinds::for_each([&]<template <class> class Kind>() {
    if (Kind<AnimatedMode>::k_name != name) return;
    Kind<AnimatedMode> kind;
    complete(kind, v);
    out = make_material<Kind>(std::move(kind));
  });
  if (out) return true;
  for (const Preset& preset : k_presets) known.push_back(preset.name);
  for (const std::string_view kind : kind_names<PlainMaterialKinds>()) known.push_back(kind);
  return document().is_complete && fail(v, unknown_name("material", name, known));
}

bool RecordReader::check_keys(const JsonValue& v, std::string_view owner, std::span<const std::string_view> known) {
  bool is_good = true;
  for (const JsonMember& m : *v.object()) {
    if (std::find(known.begin(), known.end(), m.key) != known.end()) continue;
    const bool is_to_come = is_reserved(ReservedAs::key, owner, m.key);
    is_good = fail(document().where(m.key_at), is_to_come ? fmt::format("{} is known but not built yet", in_quotes(m.key))
                                                          : fmt::format("unknown key {}{}", in_quotes(m.key), suggestion(m.key, known)));
  }
  return is_good;
}

bool RecordReader::check_row(const JsonValue& parent, const JsonMember& m, const ParameterRules& rules) {
  // Both rows of a pair name each other; one of them reports.
  if (!rules.alternative.empty() && rules.name < rules.alternative && parent.find(rules.alternative))
    return fail(document().where(m.key_at), fmt::format("\"{}\" and \"{}\" exclude each other", rules.name, rules.alternative));
  return true;
}

bool RecordReader::check_presence(const JsonValue& v, std::string_view owner, const ParameterRules& rules) {
  if (!rules.is_required || v.find(rules.name)) return true;
  if (rules.alternative.empty()) return fail(v, fmt::format("missing key \"{}\" of {}", rules.name, owner));
  if (rules.name > rules.alternative || v.find(rules.alternative)) return true;
  return fail(v, fmt::format("missing key \"{}\" or \"{}\" of {}", rules.name, rules.alternative, owner));
}

const std::string* RecordReader::read_kind_name(const JsonValue& v, std::string_view parameter, std::string_view group,
                                                std::span<const std::string_view> known) {
  if (!v.object()) return fail_type(v, parameter, fmt::format("a {} (an object with a \"kind\")", group)), nullptr;
  const JsonValue* kind = v.find("kind");
  if (!kind) return fail(v, fmt::format("{}: missing key \"kind\"; known: {}", parameter, fmt::join(known, ", "))), nullptr;
  if (!kind->string()) return fail_type(*kind, "kind", "a string"), nullptr;
  const std::string& name = *kind->string();
  if (std::find(known.begin(), known.end(), name) != known.end()) return &name;
  if (is_reserved(ReservedAs::kind, group, name))
    fail(*kind, fmt::format("the {} {} is known but not built yet", group, in_quotes(name)));
  else
    fail(*kind, unknown_kind(group, name, known));
  return nullptr;
}

} // namespace kelpie
