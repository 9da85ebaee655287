#include "morph/tree/correspondence.h"

#include <algorithm>
#include <cmath>

#include "morph/feature/match_parts.h"

namespace kelpie {

namespace {

Box3d around(const std::vector<MatchedPart>& parts) {
  Box3d box;
  for (const MatchedPart& part : parts) box.extend(part.box);
  return box;
}

/// Those that are in no link.
template <class Member>
std::vector<size_t> unlinked(size_t count, const std::vector<PartLink>& links, Member side) {
  std::vector<size_t> rest;
  for (size_t i = 0; i < count; ++i)
    if (std::none_of(links.begin(), links.end(), [&](const PartLink& link) { return link.*side == i; })) rest.push_back(i);
  return rest;
}

double log_ratio(double a, double b) { return std::abs(std::log(std::max(a, 1e-9) / std::max(b, 1e-9))); }

} // namespace

double difference_of(const MatchedPart& a, const MatchedPart& b, const Box3d& around_a, const Box3d& around_b) {
  // How much a step in each counts, beside one across half of everything.
  constexpr double k_size = 0.35, k_kind = 0.4, k_name = 1, k_leaves = 0.15, k_colour = 0.8;
  const double size_a = std::max(0.5 * around_a.diagonal(), 1e-9), size_b = std::max(0.5 * around_b.diagonal(), 1e-9);
  const Vec3d place_a = (a.box.centre() - around_a.centre()) / size_a, place_b = (b.box.centre() - around_b.centre()) / size_b;
  const bool has_other_name = a.node->name != b.node->name || a.node->name.empty();
  return glm::distance(place_a, place_b) + k_size * log_ratio(a.box.diagonal() / size_a, b.box.diagonal() / size_b) +
         k_kind * (a.node->kind.index() != b.node->kind.index()) + k_name * has_other_name +
         k_leaves * log_ratio(double(a.leaves), double(b.leaves)) + k_colour * std::min(1.0, double(glm::distance(a.colour, b.colour)));
}

std::vector<PartLink> match_children(const std::vector<MatchedPart>& from, const std::vector<MatchedPart>& to,
                                     const std::vector<PartLink>& forced) {
  std::vector<PartLink> links = forced;
  const std::vector<size_t> a = unlinked(from.size(), forced, &PartLink::from), b = unlinked(to.size(), forced, &PartLink::to);
  if (a.empty() || b.empty()) return links;
  const Box3d around_a = around(from), around_b = around(to);
  const bool is_turned = a.size() > b.size(); // rows are never more than columns
  const std::vector<size_t>&rows = is_turned ? b : a, &columns = is_turned ? a : b;
  std::vector<std::vector<double>> cost;
  for (const size_t row : rows) {
    cost.emplace_back();
    for (const size_t column : columns)
      cost.back().push_back(difference_of(from[is_turned ? column : row], to[is_turned ? row : column], around_a, around_b));
  }
  const std::vector<int> chosen = least_assignment(cost);
  for (size_t i = 0; i < rows.size(); ++i) {
    const size_t column = columns[size_t(chosen[i])];
    links.push_back(is_turned ? PartLink{column, rows[i]} : PartLink{rows[i], column});
  }
  std::sort(links.begin(), links.end(),
            [](const PartLink& x, const PartLink& y) { return std::pair(x.from, x.to) < std::pair(y.from, y.to); });
  return links;
}

} // namespace kelpie
