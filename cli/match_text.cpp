#include "cli/match_text.h"

#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "cli/json_values.h"
#include "morph/tree/plain_tree.h"

namespace kelpie {

namespace {

constexpr double k_steps = 1e6; ///< values are rounded to a millionth

std::string_view name_of(MatchedBy by) {
  switch (by) {
  case MatchedBy::place: return "place";
  case MatchedBy::pair: return "pair";
  case MatchedBy::difference: return "difference";
  case MatchedBy::division: break;
  }
  return "division";
}

std::string_view name_of(NodeFate fate) {
  switch (fate) {
  case NodeFate::becomes: return "becomes";
  case NodeFate::exchanged: return "exchanged";
  case NodeFate::shrinks: return "shrinks";
  case NodeFate::grows: break;
  }
  return "grows";
}

class TreeWriter {
public:
  TreeWriter(const TreeMatch& tree, double frame) : tree_(tree), frame_(frame) {}

  Json json() {
    Json nodes = Json::array();
    for (size_t i = 0; i < tree_.nodes.size(); ++i) nodes.push_back(match_at(i));
    return nodes;
  }

private:
  Json match_at(size_t i) {
    const NodeMatch& m = tree_.nodes[i];
    Json json{{"level", m.level}, {"within", m.within ? Json(*m.within) : Json(nullptr)}, {"fate", name_of(m.fate)}};
    if (m.from && m.to) json["by"] = name_of(m.by);
    if (m.difference) json["difference"] = rounded(*m.difference, k_steps);
    if (m.from) json["from"] = node_at(i, *m.from, m.from_ways, &NodeMatch::from_warp, from_numbers_);
    if (m.to) json["to"] = node_at(i, *m.to, m.to_ways, &NodeMatch::to_warp, to_numbers_);
    if (!m.from || !m.to) json["place"] = json_point(place_at(i), k_steps);
    json["between"] = m.between;
    return json;
  }

  Json node_at(size_t i, const FieldNode& node, size_t ways, FieldPtr NodeMatch::*warp, std::map<const FieldNode*, size_t>& numbers) {
    const size_t number = numbers.try_emplace(&node, numbers.size()).first->second;
    Box3d box;
    for (const Box3d& piece : in_space_of_root(tree_, i, warp, frame_, {box_of_tree(node, frame_)})) box.extend(piece);
    return {{"node", number},
            {"kind", std::visit([](const auto& kind) { return kind.k_name; }, node.kind)},
            {"name", node.name},
            {"where", to_string(node.where)},
            {"leaves", leaf_count(node)},
            {"centre", json_point(box.centre(), k_steps)},
            {"size", json_point(box.extent(), k_steps)},
            {"share", 1 / double(ways)}};
  }

  Vec3d place_at(size_t i) const {
    const NodeMatch& m = tree_.nodes[i];
    const Vec3d place(m.place);
    return in_space_of_root(tree_, i, m.from ? &NodeMatch::from_warp : &NodeMatch::to_warp, frame_, {{place, place}}).front().centre();
  }

  const TreeMatch& tree_;
  double frame_;
  std::map<const FieldNode*, size_t> from_numbers_, to_numbers_; ///< in the order in which they are met
};

Json json_of(const Blob& blob) { return {{"centre", json_point(Vec3d(blob.centre), k_steps)}, {"radius", blob.radius}}; }

Json json_of(const MatchedLiquid& liquid) {
  const std::vector<double> amounts = amounts_of(liquid);
  Json parts = Json::array();
  for (size_t i = 0; i < liquid.from.size(); ++i)
    parts.push_back({{"amount", amounts[i]}, {"from", json_of(liquid.from[i])}, {"to", json_of(liquid.to[i])}});
  return {{"kind", "liquid"},          {"where", to_string(liquid.where)}, {"shapes", liquid.shapes},
          {"passage", liquid.passage}, {"passages", liquid.passages},      {"parts", parts}};
}

std::string summary_of(const GrownTree& tree) {
  const auto count = [&](auto is) { return std::count_if(tree.match.nodes.begin(), tree.match.nodes.end(), is); };
  const auto by = [&](MatchedBy how) { return count([=](const NodeMatch& m) { return m.from && m.to && m.by == how; }); };
  const auto fated = [&](NodeFate fate) { return count([=](const NodeMatch& m) { return m.fate == fate; }); };
  return fmt::format("{}: animorphosis of {}: {} forced, {} found, {} by division, {} by their places; {} shrink, {} grow, {} exchanged\n",
                     to_string(tree.root->where), fmt::join(tree.shapes, ", "), by(MatchedBy::pair), by(MatchedBy::difference),
                     by(MatchedBy::division), by(MatchedBy::place), fated(NodeFate::shrinks), fated(NodeFate::grows),
                     fated(NodeFate::exchanged));
}

} // namespace

std::string title_of(const MatchedLiquid& liquid) {
  const std::string passage = liquid.passages > 1 ? fmt::format(", passage {} of {}", liquid.passage, liquid.passages) : "";
  return fmt::format("{}: liquid of {}{}", to_string(liquid.where), fmt::join(liquid.shapes, ", "), passage);
}

std::vector<double> amounts_of(const MatchedLiquid& liquid) {
  std::vector<double> amounts;
  double sum = 0;
  for (const Blob& b : liquid.from) {
    amounts.push_back(std::abs(double(b.weight)) * std::pow(double(b.radius), 3));
    sum += amounts.back();
  }
  for (double& amount : amounts) amount /= sum;
  return amounts;
}

std::string match_json(const MatchReport& r) {
  Json matches = Json::array();
  for (const GrownTree& tree : r.trees) {
    const double frame = r.frame_of(tree);
    matches.push_back({{"kind", "animorphosis"},
                       {"where", to_string(tree.root->where)},
                       {"shapes", tree.shapes},
                       {"compared_at", tree.match.frame},
                       {"frame", frame},
                       {"parts", TreeWriter(tree.match, frame).json()}});
  }
  for (const MatchedLiquid& liquid : r.liquids) matches.push_back(json_of(liquid));
  return Json{{"version", KELPIE_VERSION}, {"scene", r.scene}, {"matches", matches}}.dump(1) + "\n";
}

std::string match_summary(const MatchReport& r) {
  std::string text;
  for (const GrownTree& tree : r.trees) text += summary_of(tree);
  for (const MatchedLiquid& liquid : r.liquids) text += fmt::format("{}: {} parts\n", title_of(liquid), liquid.from.size());
  return text;
}

} // namespace kelpie
