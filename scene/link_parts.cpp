#include "scene/link_parts.h"

#include <numeric>
#include <unordered_map>

#include "morph/field_fold.h"

namespace kelpie {

namespace {

/// Calls visit(reference) for those of one node.
template <class Node, class Visit>
void for_each_reference(Node& node, Visit&& visit) {
  std::visit(
      [&](auto& kind) {
        for_each_edge(kind, [&]<class Edge>(Edge& edge, const ParameterRules&) {
          if constexpr (std::is_same_v<std::remove_const_t<Edge>, PartReference>) visit(edge);
        });
      },
      node.kind);
}

/// Calls visit(child) for those of one node that could be read.
template <class Visit>
void for_each_child(const FieldNode& node, Visit&& visit) {
  std::visit(
      [&](const auto& kind) {
        for_each_edge(kind, [&]<class Edge>(const Edge& edge, const ParameterRules&) {
          if constexpr (std::is_same_v<Edge, FieldPtr>)
            if (edge) visit(*edge);
        });
      },
      node.kind);
}

/// Whether there was a name; if not, that has been reported.
bool is_read(const PartReference& reference) { return !reference.where.file.empty(); }

/// The parts as a graph. Nothing here recurses through references: a chain of them may be as long as a file.
class PartGraph {
public:
  PartGraph(const std::vector<ReadNode>& nodes, Scene& scene, const Document& document, ProblemList& problems)
      : scene_(scene), document_(document), problems_(problems) {
    for (const auto& [name, field] : scene_.parts) index_of_.emplace(name, parts_.size()), parts_.push_back({name, field.get(), {}, 0});
    for (const ReadNode& n : nodes) for_each_reference(*n.node, [&](PartReference& reference) { references_.push_back(&reference); });
    for (Part& part : parts_) collect_references(*part.field, part.references);
  }

  void check_names() {
    if (!document_.is_complete) return; // a name may have been in what is missing
    std::vector<std::string_view> known;
    for (const Part& part : parts_) known.push_back(part.name);
    for (const PartReference* reference : references_)
      if (is_read(*reference) && target(*reference) == k_none)
        problems_.add(reference->where, unknown_name("part", reference->name, known));
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
        const PartReference* reference = parts_[at].references[next];
        const size_t to = target(*reference);
        if (to == k_none || states[to] == State::done) continue;
        if (states[to] == State::open) {
          problems_.add(reference->where, describe_cycle(path, to));
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
      for (const FieldPtr& tree : {shape.field, shape.texture})
        if (tree) height(*tree, 1);
    return !is_too_deep_;
  }

  /// Only what is sound: shared pointers in a ring would never be freed, those in a long chain not without a deep stack.
  void link() {
    for (PartReference* reference : references_)
      if (const auto found = scene_.parts.find(reference->name); found != scene_.parts.end()) reference->target = found->second;
  }

private:
  static constexpr size_t k_none = ~size_t{0};

  struct Part {
    std::string_view name;
    const FieldNode* field;
    std::vector<const PartReference*> references; ///< in it
    size_t height;                                ///< of its nodes in one another
  };

  void collect_references(const FieldNode& node, std::vector<const PartReference*>& out) const {
    for_each_reference(node, [&](const PartReference& reference) { out.push_back(&reference); });
    for_each_child(node, [&](const FieldNode& child) { collect_references(child, out); });
  }

  size_t target(const PartReference& reference) const {
    const auto found = index_of_.find(reference.name);
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
    for_each_child(node, [&](const FieldNode& child) { below = std::max(below, height(child, depth + 1)); });
    for_each_reference(node, [&](const PartReference& reference) { below = std::max(below, height_below(reference, depth)); });
    return below + 1;
  }

  /// The same of what a node at `depth` refers to.
  size_t height_below(const PartReference& reference, size_t depth) {
    const size_t to = target(reference), height = to == k_none ? 0 : parts_[to].height;
    if (depth + height <= limit_) return height;
    if (!is_too_deep_) problems_.add(reference.where, fmt::format("more than {} fields in one another", limit_));
    is_too_deep_ = true;
    return 0;
  }

  Scene& scene_;
  const Document& document_;
  ProblemList& problems_;
  std::vector<Part> parts_;
  std::unordered_map<std::string_view, size_t> index_of_;
  std::vector<PartReference*> references_;
  std::vector<size_t> order_;
  size_t limit_ = 0;
  bool is_too_deep_ = false;
};

/// How many elements something that was loaded is, beside the node that holds it.
size_t element_count(const BlobCloud& cloud) { return cloud.size(); }
size_t element_count(const LiquidChain& chain) { return chain.part_count(); }
size_t element_count(const DistanceGrid&) { return 0; }
size_t element_count(const SubdivisionMesh&) { return 0; } // its pieces are another frame's others

/// A node's own elements.
template <class Kind>
double own_element_count(const Kind& kind) {
  double count = 1;
  if constexpr (HasAssets<Kind>) for_each_asset(kind, [&](const auto& asset) { count += static_cast<double>(element_count(*asset)); });
  return count;
}

} // namespace

void link_parts(const std::vector<ReadNode>& nodes, Scene& scene, const Document& document, ProblemList& problems,
                const PartLimits& limits) {
  PartGraph graph(nodes, scene, document, problems);
  graph.check_names();
  if (graph.sort() && graph.check_depth(limits.depth)) graph.link();
}

void check_size(const Scene& scene, ProblemList& problems, const PartLimits& limits) {
  FieldFold<double> counter(PartsShared::always);
  const auto visit = [](const FieldNode&, const auto& kind, const TimeMap&, std::span<const double> below) {
    return std::accumulate(below.begin(), below.end(), own_element_count(kind));
  };
  double total = 0;
  for (const Shape& shape : scene.shapes) {
    for (const FieldPtr& tree : {shape.field, shape.texture})
      if (tree) total += counter(*tree, visit);
    if (total > limits.elements)
      return problems.add((shape.field ? shape.field : shape.texture)->where,
                          fmt::format("with this field the scene has {:.3g} elements, more than {}", total, limits.elements));
  }
}

} // namespace kelpie
