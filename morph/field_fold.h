// The one way through a field tree.
#pragma once

#include <map>
#include <span>
#include <vector>

#include "base/time_map.h"
#include "morph/field_node.h"

namespace kelpie {

/// Which references to a part share what is made of it.
enum class PartsShared { always, in_one_time };

/// Makes something of a tree from its leaves up, with all that it refers to. A part is visited once, or once for each time in which it is
/// referred to, whichever of several trees comes to it first; below a kind with `k_owns_parts`, which changes what is made of them, once
/// for each reference. For trees whose references are linked, and all of whose children are there.
template <class Result>
class FieldFold {
public:
  explicit FieldFold(PartsShared shared) : shared_(shared) {}

  /// Calls visit(node, its kind, its time, span of the results of its edges in the order of for_each_edge) for every node, after those
  /// that it stands on; returns what it made of the last one, the root.
  template <class Visit>
  Result operator()(const FieldNode& root, const Visit& visit) {
    return fold(root, {{}, false}, visit);
  }

private:
  /// How a node is come to.
  struct Way {
    TimeMap time;
    bool owns_parts; ///< what is below it is shared with nothing else
  };

  template <class Visit>
  Result fold(const FieldNode& node, const Way& way, const Visit& visit) {
    return std::visit(
        [&](const auto& kind) {
          const size_t first = results_.size();
          const Way below = way_below(kind, way);
          for_each_edge(kind, [&](const auto& edge, const ParameterRules&) { results_.push_back(follow(edge, below, visit)); });
          const Result result = visit(node, kind, way.time, std::span<const Result>(results_).subspan(first));
          results_.resize(first);
          return result;
        },
        node.kind);
  }

  /// A kind that gives what is below it a time of its own has `TimeMap time_below() const`.
  template <class Kind>
  static Way way_below(const Kind& kind, Way way) {
    if constexpr (requires { kind.time_below(); }) way.time = way.time.then(kind.time_below());
    if constexpr (requires { Kind::k_owns_parts; }) way.owns_parts = true;
    return way;
  }

  template <class Visit>
  Result follow(const FieldPtr& child, const Way& way, const Visit& visit) {
    return fold(*child, way, visit);
  }
  template <class Visit>
  Result follow(const PartReference& part, const Way& way, const Visit& visit) {
    if (way.owns_parts && shared_ == PartsShared::in_one_time) return fold(*part.target, way, visit);
    const std::pair key{part.target.get(), shared_ == PartsShared::always ? TimeMap{} : way.time};
    if (const auto known = parts_.find(key); known != parts_.end()) return known->second;
    const Result result = fold(*part.target, way, visit);
    parts_.emplace(key, result);
    return result;
  }

  PartsShared shared_;
  std::vector<Result> results_; ///< of the edges of all nodes on the way from the root
  std::map<std::pair<const FieldNode*, TimeMap>, Result> parts_;
};

} // namespace kelpie
