#include "scene/include_files.h"

#include <algorithm>
#include <set>
#include <unordered_map>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace kelpie {

namespace {

/// The objects that are merged, and what one entry is called.
constexpr std::array<std::pair<std::string_view, std::string_view>, 4> k_merged{
    {{"variables", "variable"}, {"materials", "material"}, {"parts", "part"}, {"recipes", "recipe"}}};

/// The member of that name, if it is an object.
JsonValue::Object* find_object(JsonValue& parent, std::string_view key) {
  if (auto* members = std::get_if<JsonValue::Object>(&parent.data))
    for (JsonMember& m : *members)
      if (m.key == key) return std::get_if<JsonValue::Object>(&m.value.data);
  return nullptr;
}

class Includer {
public:
  Includer(Document& document, const AssetFolder& folder, ProblemList& problems, const IncludeLimits& limits)
      : document_(document), folder_(folder), problems_(problems), limits_(limits) {}

  std::vector<JsonValue> run() {
    // The scene stands at the beginning of every chain, so that what includes it is seen to do so.
    chain_.push_back({document_.sources[0].name, folder_.scene_file()});
    include_all(document_.root);
    for (JsonValue& library : libraries_) merge(library);
    return std::move(libraries_);
  }

private:
  struct File {
    std::string name;     ///< as errors call it
    std::string resolved; ///< which file it is
  };

  void include_all(const JsonValue& root) {
    const JsonValue* list = root.find("include");
    if (!list || !list->array()) return; // the reader reports
    for (const JsonValue& e : *list->array())
      if (e.string()) include(e);
  }

  /// Depth first.
  void include(const JsonValue& path) {
    const DocumentSource& from = document_.sources.at(path.at.source);
    const std::filesystem::path as_written = *path.string();
    File file;
    try {
      file.resolved = folder_.resolve(from.folder, as_written, from.is_command_line);
    } catch (const Error& e) {
      return fail(path, e.problems[0].message, e.status);
    }
    const std::filesystem::path inner = from.folder / as_written;
    file.name = (std::filesystem::path(document_.sources[0].name).parent_path() / inner).lexically_normal().string();
    if (is_cycle(file, path) || !seen_.insert(file.resolved).second) return;
    if (chain_.size() > limits_.depth) return fail(path, fmt::format("more than {} files include one another", limits_.depth));
    if (seen_.size() > limits_.files) return fail(path, fmt::format("more than {} files are included", limits_.files));

    const auto source = static_cast<std::uint32_t>(document_.sources.size());
    document_.sources.push_back({file.name, inner.parent_path(), false});
    JsonValue root;
    try {
      root = read_source(file.resolved, source, document_, problems_, limits_.all);
    } catch (const Error& e) { // its syntax: the rest can still be checked
      document_.is_complete = false;
      return problems_.add(e, document_.where(path.at));
    }
    chain_.push_back(std::move(file));
    include_all(root);
    chain_.pop_back();
    libraries_.push_back(std::move(root));
  }

  bool is_cycle(const File& file, const JsonValue& path) {
    const auto same = [&](const File& f) { return f.resolved == file.resolved; };
    auto from = std::find_if(chain_.begin(), chain_.end(), same);
    if (from == chain_.end()) return false;
    std::string names;
    for (; from != chain_.end(); ++from) names += from->name + " > ";
    fail(path, fmt::format("a cycle: {}{}", names, file.name));
    return true;
  }

  void fail(const JsonValue& path, const std::string& message, ExitStatus status = ExitStatus::bad_data) {
    document_.is_complete = false;
    problems_.add(document_.where(path.at), "include: " + message, status);
  }

  void merge(JsonValue& library) {
    for (const auto& [key, what] : k_merged) {
      JsonValue::Object* from = find_object(library, key);
      if (!from || from->empty()) continue;
      JsonValue::Object& to = object_of_scene(key);
      auto& places = places_[key];
      if (places.empty())
        for (const JsonMember& m : to) places.emplace(m.key, m.key_at);
      for (JsonMember& m : *from) {
        const auto [taken, is_new] = places.emplace(m.key, m.key_at);
        if (!is_new && taken->second.source != m.key_at.source) // twice in one file is reported as a duplicate key
          problems_.add(document_.where(m.key_at), fmt::format("two {}s are called {} (the other: {})", what, in_quotes(m.key),
                                                               to_string(document_.where(taken->second))));
        if (is_new) to.push_back(std::move(m));
      }
      from->clear();
    }
  }

  /// What is no object is for the reader to report; then what is included goes nowhere.
  JsonValue::Object& object_of_scene(std::string_view key) {
    JsonValue::Object* scene = std::get_if<JsonValue::Object>(&document_.root.data);
    if (!document_.root.find(key)) scene->push_back({std::string(key), document_.root.at, {JsonValue::Object{}, document_.root.at}});
    JsonValue::Object* object = find_object(document_.root, key);
    return object ? *object : nowhere_;
  }

  Document& document_;
  const AssetFolder& folder_;
  ProblemList& problems_;
  const IncludeLimits& limits_;
  std::vector<File> chain_;    ///< the files that are being included, each by the one before it
  std::set<std::string> seen_; ///< resolved
  std::vector<JsonValue> libraries_;
  std::map<std::string_view, std::unordered_map<std::string, TextPosition>> places_; ///< of the scene's parts and surfaces
  JsonValue::Object nowhere_;
};

} // namespace

std::vector<JsonValue> include_files(Document& document, const AssetFolder& folder, ProblemList& problems, const IncludeLimits& limits) {
  return Includer(document, folder, problems, limits).run();
}

} // namespace kelpie
