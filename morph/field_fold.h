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
/// referred to, whichever of several trees comes to it first. For trees whose references are linked, and all of whose children are there.
template <class Result>
class FieldFold {
public:
  explicit FieldFold(PartsShared shared) : shared_(shared) {}

  /// Calls visit(node, its kind, its time, span of the results of its edges in the order of for_each_edge) for every node, after those
  /// that it stands on; returns what it made of the last one, the root.
  template <class Visit>
  Result operator()(const FieldNode& root, const Visit& visit) {
    return fold(root, {}, visit);
  }

private:
  template <class Visit>
  Result fold(const FieldNode& node, const TimeMap& time, const Visit& visit) {
    return std::visit(
        [&](const auto& kind) {
          const size_t first = results_.size();
          const TimeMap below = time_below(kind, time);
          for_each_edge(kind, [&](const auto& edge, const ParameterRules&) { results_.push_back(follow(edge, below, visit)); });
          const Result result = visit(node, kind, time, std::span<const Result>(results_).subspan(first));
          results_.resize(first);
          return result;
        },
        node.kind);
  }

  /// A kind that gives what is below it a time of its own has `TimeMap time_below() const`.
  template <class Kind>
  static TimeMap time_below(const Kind& kind, const TimeMap& time) {
    if constexpr (requires { kind.time_below(); })
      return time.then(kind.time_below());
    else
      return time;
  }

  template <class Visit>
  Result follow(const FieldPtr& child, const TimeMap& time, const Visit& visit) {
    return fold(*child, time, visit);
  }
  template <class Visit>
  Result follow(const PartReference& part, const TimeMap& time, const Visit& visit) {
    const std::pair key{part.target.get(), shared_ == PartsShared::always ? TimeMap{} : time};
    if (const auto known = parts_.find(key); known != parts_.end()) return known->second;
    const Result result = fold(*part.target, time, visit);
    parts_.emplace(key, result);
    return result;
  }

  PartsShared shared_;
  std::vector<Result> results_; ///< of the edges of all nodes on the way from the root
  std::map<std::pair<const FieldNode*, TimeMap>, Result> parts_;
};

} // namespace kelpie
