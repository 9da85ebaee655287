#include "scene/record_reader.h"

namespace kelpie {

std::string unknown_name(std::string_view what, std::string_view name, std::span<const std::string_view> known) {
  const std::string hint = known.empty() ? fmt::format(": the scene has no {}s", what) : suggestion(name, known);
  return fmt::format("unknown {} {}{}", what, in_quotes(name), hint);
}

bool RecordReader::read(FieldPtr& out, const JsonValue& v, const ParameterRules& rules) {
  auto node = std::make_shared<FieldNode>();
  node->where = where(v);
  const bool is_good = read(node->kind, v, rules);
  nodes_.push_back({node, &v});
  out = std::move(node);
  return is_good;
}

bool RecordReader::read_named(SurfaceKinds::Variant<AnimatedMode>& out, const JsonValue& v) {
  const std::string& name = *v.string();
  if (surfaces_ && surfaces_->count(name)) {
    out = surfaces_->at(name);
    return true;
  }
  std::vector<std::string_view> known;
  if (surfaces_)
    for (const auto& entry : *surfaces_) known.push_back(entry.first);
  return document().is_complete && fail(v, unknown_name("surface", name, known));
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
    fail(*kind, fmt::format("unknown kind of {} {}{}", group, in_quotes(name), suggestion(name, known)));
  return nullptr;
}

} // namespace kelpie
