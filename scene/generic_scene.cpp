#include "scene/generic_scene.h"

#include <cmath>
#include <filesystem>

#include <fmt/format.h>

#include "scene/field_json.h"

namespace kelpie {

namespace {

using Json = FieldWriter::Json;

/// Files read best with what is short in one line.
constexpr size_t k_line = 140;

void print(const Json& v, std::string& out, size_t indent) {
  std::string line = v.dump();
  if (!v.is_structured() || v.empty() || indent + line.size() <= k_line) {
    out += line;
    return;
  }
  out += v.is_object() ? "{" : "[";
  bool is_first = true;
  for (const auto& [key, member] : v.items()) {
    out += fmt::format("{}\n{:{}}", is_first ? "" : ",", "", indent + 2);
    if (v.is_object()) out += Json(key).dump() + ": ";
    print(member, out, indent + 2);
    is_first = false;
  }
  out += fmt::format("\n{:{}}{}", "", indent, v.is_object() ? "}" : "]");
}

/// Copies a document, but for its animorphoses.
class Rewriter {
public:
  Rewriter(const Document& document, const std::vector<GrownTree>& trees, FieldWriter& writer)
      : document_(document), trees_(trees), writer_(writer) {}

  Json copy(const JsonValue& v) {
    if (const GrownTree* tree = tree_at(v)) {
      ++replaced_;
      return writer_.tree(*tree->root);
    }
    if (const JsonValue::Object* object = v.object()) {
      Json out = Json::object();
      for (const JsonMember& member : *object) out[member.key] = copy(member.value);
      return out;
    }
    if (const JsonValue::Array* array = v.array()) {
      Json out = Json::array();
      for (const JsonValue& element : *array) out.push_back(copy(element));
      return out;
    }
    if (const double* number = v.number()) {
      const bool is_whole = *number == std::floor(*number) && std::abs(*number) < 1e15;
      return is_whole ? Json(static_cast<std::int64_t>(*number)) : Json(*number);
    }
    if (const bool* boolean = v.boolean()) return *boolean;
    if (const std::string* string = v.string()) return *string;
    return {};
  }
  size_t replaced() const { return replaced_; }

private:
  const GrownTree* tree_at(const JsonValue& v) const {
    const JsonValue* kind = v.find("kind");
    if (!kind || !kind->string() || *kind->string() != Animorphosis<AnimatedMode>::k_name) return nullptr;
    const SourcePosition at = document_.where(v.at);
    for (const GrownTree& tree : trees_) {
      const SourcePosition& stands = tree.root->where;
      if (stands.file == at.file && stands.line == at.line && stands.column == at.column) return &tree;
    }
    return nullptr;
  }

  const Document& document_;
  const std::vector<GrownTree>& trees_;
  FieldWriter& writer_;
  size_t replaced_ = 0;
};

} // namespace

GenericScene generic_scene(const std::string& path, const Scene& scene, const std::vector<GrownTree>& trees) {
  ProblemList problems;
  const Document document = read_document(path, problems);
  // The shutter of the first frame is open before it, that of the last one after it.
  FieldWriter writer(scene.frames.first - 1, scene.frames.last + 1, std::filesystem::absolute(path).parent_path(), scene.materials);
  Rewriter rewriter(document, trees, writer);
  Json root = rewriter.copy(document.root);
  if (rewriter.replaced() == 0)
    throw Error(ExitStatus::bad_data,
                trees.empty() ? "no shape has an animorphosis"
                              : "its animorphoses stand in files that it includes: no tree can be saved here",
                {path});
  for (const auto& [name, material] : writer.materials().items()) root["materials"][name] = material;
  GenericScene out{{}, rewriter.replaced(), writer.curves(), writer.keys(), writer.error()};
  print(root, out.text, 0);
  out.text += "\n";
  return out;
}

} // namespace kelpie
