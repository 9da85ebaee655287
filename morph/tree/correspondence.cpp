#include "morph/tree/correspondence.h"

#include <algorithm>
#include <cmath>

#include "morph/feature/match_parts.h"
#include "morph/tree/leaf_between.h"

namespace kelpie {

namespace {

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

Box3d box_around(const std::vector<MatchedPart>& parts) {
  Box3d box;
  for (const MatchedPart& part : parts) box.extend(part.box);
  return box;
}

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
  const Box3d around_a = box_around(from), around_b = box_around(to);
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

std::vector<PartLink> links_in_order(size_t from, size_t to) {
  std::vector<PartLink> links;
  for (size_t i = 0; i < std::min(from, to); ++i) links.push_back({i, i});
  return links;
}

void divide_leaves(std::vector<PartLink>& links, const std::vector<MatchedPart>& from, const std::vector<MatchedPart>& to) {
  const auto can_be = [&](const PartLink& l) {
    return from[l.from].leaves == 1 && to[l.to].leaves == 1 && common_path(from[l.from].node->kind, to[l.to].node->kind).has_value();
  };
  const Box3d around_from = box_around(from), around_to = box_around(to);
  const std::vector<PartLink> whole = links;
  const auto add = [&](size_t count, size_t PartLink::*own) {
    for (const size_t i : unlinked(count, whole, own)) {
      std::optional<PartLink> best;
      double least = std::numeric_limits<double>::infinity();
      for (PartLink link : whole) {
        link.*own = i;
        const double difference = difference_of(from[link.from], to[link.to], around_from, around_to);
        if (difference < least && can_be(link)) least = difference, best = link;
      }
      if (best) links.push_back(*best);
    }
  };
  add(from.size(), &PartLink::from), add(to.size(), &PartLink::to);
}

Vec3 drift_between(const Box3d& from, const Box3d& to) {
  constexpr double k_endless = 1e5; // of what has no end nobody knows where it is
  return from.diagonal() < k_endless && to.diagonal() < k_endless ? Vec3(to.centre() - from.centre()) : Vec3(0);
}

Anchor anchor_of(const MatchedPart& part, const std::vector<MatchedPart>& own, const std::vector<MatchedPart>& others,
                 const std::vector<PartLink>& links, size_t PartLink::*side) {
  size_t PartLink::*const other_side = side == &PartLink::from ? &PartLink::to : &PartLink::from;
  const Vec3d middle = part.box.centre();
  Anchor nearest{Vec3(middle)};
  double least = std::numeric_limits<double>::infinity();
  for (const PartLink& link : links) {
    const Box3d& neighbour = own[link.*side].box;
    const double away = glm::distance(glm::clamp(middle, neighbour.lower, neighbour.upper), middle);
    if (away >= least) continue;
    least = away;
    nearest.place = Vec3(glm::clamp(neighbour.centre(), part.box.lower, part.box.upper));
    nearest.drift = drift_between(neighbour, others[link.*other_side].box);
  }
  return nearest;
}

} // namespace kelpie
