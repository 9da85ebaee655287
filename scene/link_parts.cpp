#include "scene/link_parts.h"

#include <unordered_map>

namespace kelpie {

namespace {

using InstanceNode = Instance<AnimatedMode>;

/// The parts as a graph. Nothing here recurses through references: a chain of them may be as long as a file.
class PartGraph {
public:
  PartGraph(const std::vector<ReadNode>& nodes, Scene& scene, const Document& document, ProblemList& problems)
      : scene_(scene), document_(document), problems_(problems) {
    for (const auto& [name, field] : scene_.parts) index_of_.emplace(name, parts_.size()), parts_.push_back({name, field.get(), {}, 0});
    for (const ReadNode& n : nodes)
      if (auto* instance = std::get_if<InstanceNode>(&n.node->kind)) {
        instances_.push_back(instance);
        sources_.emplace(instance, n.source->find("of"));
      }
    for (Part& part : parts_) collect_references(*part.field, part.references);
  }

  void check_names() {
    std::vector<std::string_view> known;
    for (const Part& part : parts_) known.push_back(part.name);
    for (const InstanceNode* instance : instances_) {
      const JsonValue* of = sources_.at(instance);
      const bool is_reported = !of || !of->string() || !document_.is_complete;
      if (!is_reported && target(*instance) == k_none)
        problems_.add(document_.where(of->at), unknown_name("part", instance->of.name, known));
    }
  }

  /// Orders the parts, used ones before their users, and reports every cycle, without which there would be no such order.
  bool sort() {
    enum class State { fresh, open, done };
    std::vector<State> states(parts_.size(), State::fresh);
    std::vector<std::pair<size_t, size_t>> path; // parts, each with its next reference
    bool is_sound = true;
    for (size_t start = 0; start < parts_.size(); ++start) {
      if (states[start] == State::fresh) path.emplace_back(start, 0), states[start] = State::open;
      while (!path.empty()) {
        const auto [at, next] = path.back();
        if (next == parts_[at].references.size()) {
          order_.push_back(at), states[at] = State::done, path.pop_back();
          continue;
        }
        ++path.back().second;
        const InstanceNode* reference = parts_[at].references[next];
        const size_t to = target(*reference);
        if (to == k_none || states[to] == State::done) continue;
        if (states[to] == State::open) {
          problems_.add(document_.where(sources_.at(reference)->at), describe_cycle(path, to));
          is_sound = false;
        } else {
          path.emplace_back(to, 0), states[to] = State::open;
        }
      }
    }
    return is_sound;
  }

  /// Reports the first reference that leads too deep.
  bool check_depth(size_t limit) {
    limit_ = limit;
    for (const size_t i : order_) parts_[i].height = height(*parts_[i].field, 1);
    for (const Shape& shape : scene_.shapes)
      if (shape.field) height(*shape.field, 1);
    return !is_too_deep_;
  }

  /// Only what is sound: shared pointers in a ring would never be freed, those in a long chain not without a deep stack.
  void link() {
    for (InstanceNode* instance : instances_)
      if (const auto found = scene_.parts.find(instance->of.name); found != scene_.parts.end()) instance->child = found->second;
  }

private:
  static constexpr size_t k_none = ~size_t{0};

  struct Part {
    std::string_view name;
    const FieldNode* field;
    std::vector<const InstanceNode*> references; ///< in it
    size_t height;                               ///< of its nodes in one another
  };

  void collect_references(const FieldNode& node, std::vector<const InstanceNode*>& out) const {
    if (const auto* instance = std::get_if<InstanceNode>(&node.kind)) out.push_back(instance);
    for_each_child(node, [&](const FieldPtr& child) {
      if (child) collect_references(*child, out);
    });
  }

  size_t target(const InstanceNode& instance) const {
    const auto found = index_of_.find(instance.of.name);
    return found == index_of_.end() ? k_none : found->second;
  }

  std::string describe_cycle(const std::vector<std::pair<size_t, size_t>>& path, size_t to) const {
    constexpr size_t k_most = 8; // names in a line
    std::string chain;
    size_t from = path.size();
    while (path[--from].first != to) {
    }
    for (size_t i = from; i < path.size(); ++i) {
      if (i - from < k_most) chain += in_quotes(parts_[path[i].first].name) + " > ";
      if (i - from == k_most) chain += "… > ";
    }
    return fmt::format("a cycle of parts: {}{}", chain, in_quotes(parts_[to].name));
  }

  /// How deep nodes stand in one another below and with this one, which itself stands at `depth`.
  size_t height(const FieldNode& node, size_t depth) {
    size_t below = 0;
    for_each_child(node, [&](const FieldPtr& child) {
      if (child) below = std::max(below, height(*child, depth + 1));
    });
    const auto* instance = std::get_if<InstanceNode>(&node.kind);
    if (!instance) return below + 1;
    const size_t to = target(*instance);
    below = to == k_none ? 0 : parts_[to].height;
    if (depth + below <= limit_) return below + 1;
    if (!is_too_deep_) problems_.add(document_.where(sources_.at(instance)->at), fmt::format("more than {} fields in one another", limit_));
    is_too_deep_ = true;
    return 1;
  }

  Scene& scene_;
  const Document& document_;
  ProblemList& problems_;
  std::vector<Part> parts_;
  std::unordered_map<std::string_view, size_t> index_of_;
  std::vector<InstanceNode*> instances_;
  std::unordered_map<const InstanceNode*, const JsonValue*> sources_; ///< where they say what they are of
  std::vector<size_t> order_;
  size_t limit_ = 0;
  bool is_too_deep_ = false;
};

/// Nodes, and blobs of clouds, with all that instances refer to.
class ElementCounter {
public:
  double count(const FieldNode& node) {
    double n = std::visit([&](const auto& kind) { return 1 + own(kind); }, node.kind);
    for_each_child(node, [&](const FieldPtr& child) { n += count(*child); });
    return n;
  }

private:
  template <class Kind>
  double own(const Kind& kind) {
    if constexpr (requires { kind.cloud; }) return static_cast<double>(kind.cloud->size());
    if constexpr (requires { kind.morph; }) return static_cast<double>(kind.morph->part_count());
    return 0;
  }
  double own(const InstanceNode& instance) {
    const auto found = parts_.find(instance.child.get());
    return found != parts_.end() ? found->second : parts_[instance.child.get()] = count(*instance.child);
  }

  std::unordered_map<const FieldNode*, double> parts_;
};

} // namespace

void link_parts(const std::vector<ReadNode>& nodes, Scene& scene, const Document& document, ProblemList& problems,
                const PartLimits& limits) {
  PartGraph graph(nodes, scene, document, problems);
  graph.check_names();
  if (graph.sort() && graph.check_depth(limits.depth)) graph.link();
}

void check_size(const Scene& scene, ProblemList& problems, const PartLimits& limits) {
  ElementCounter counter;
  double total = 0;
  for (const Shape& shape : scene.shapes) {
    if (!shape.field) continue;
    total += counter.count(*shape.field);
    if (total > limits.elements)
      return problems.add(shape.field->where,
                          fmt::format("with this field the scene has {:.3g} elements, more than {}", total, limits.elements));
  }
}

} // namespace kelpie
