// What `kelpie match` draws.
#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "cli/match_drawing.h"
#include "cli/match_text.h"
#include "morph/tree/plain_tree.h"

namespace kelpie {

namespace {

constexpr double k_golden_angle = 137.508;                            // hues of any number of parts in a row are far apart
constexpr double k_found = 1.2, k_forced = 3, k_all_of_a_liquid = 40; // widths of links, pixels

std::string name_of(const FieldNode& node) {
  return node.name.empty() ? std::string(std::visit([](const auto& kind) { return kind.k_name; }, node.kind)) : node.name;
}

class TreeDrawer {
public:
  TreeDrawer(const TreeMatch& tree, double frame) : tree_(tree), frame_(frame), has_below_(tree.nodes.size()) {
    for (const NodeMatch& m : tree.nodes)
      if (m.within) has_below_[*m.within] = true;
    for (size_t i = 0; i < tree.nodes.size(); ++i)
      if (!has_below_[i]) add(i);
    add_labels(drawing_.from, &NodeMatch::from, &NodeMatch::from_warp);
    add_labels(drawing_.to, &NodeMatch::to, &NodeMatch::to_warp);
  }

  MatchDrawing take() { return std::move(drawing_); }

private:
  /// A match with none below it: leaves, mostly.
  void add(size_t i) {
    const NodeMatch& m = tree_.nodes[i];
    DrawnPart part;
    part.hue = std::fmod(k_golden_angle * double(i), 360);
    part.look = m.fate == NodeFate::becomes ? DrawnPart::Look::paired
                : m.from && m.to            ? DrawnPart::Look::exchanged
                                            : DrawnPart::Look::loose;
    part.title = title_of(m);
    if (m.from) add_to(drawing_.from, part, i, &NodeMatch::from, &NodeMatch::from_warp);
    if (m.to) add_to(drawing_.to, part, i, &NodeMatch::to, &NodeMatch::to_warp);
    if (m.from && m.to)
      drawing_.links.push_back(
          {drawing_.from.parts.size() - 1, drawing_.to.parts.size() - 1, m.by == MatchedBy::pair ? k_forced : k_found});
  }

  void add_to(DrawnEnd& end, DrawnPart part, size_t i, FieldPtr NodeMatch::*side, FieldPtr NodeMatch::*warp) const {
    const NodeMatch& m = tree_.nodes[i];
    part.pieces = in_space_of_root(tree_, i, warp, frame_, boxes_of_tree(*(m.*side), frame_));
    std::erase_if(part.pieces, [](const Box3d& box) { return !(box.diagonal() > 0 && box.diagonal() < k_endless); });
    const Vec3d place(m.place);
    if (!m.from || !m.to) part.place = in_space_of_root(tree_, i, warp, frame_, {{place, place}}).front().centre();
    end.parts.push_back(std::move(part));
  }

  /// Those of names first, from the roots on; then the kinds of what has none.
  void add_labels(DrawnEnd& end, FieldPtr NodeMatch::*side, FieldPtr NodeMatch::*warp) const {
    std::vector<size_t> order(tree_.nodes.size());
    std::iota(order.begin(), order.end(), 0);
    std::erase_if(order, [&](size_t i) {
      const FieldPtr& node = tree_.nodes[i].*side;
      return !node || (node->name.empty() && has_below_[i]);
    });
    std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) {
      const auto rank = [&](size_t i) { return std::pair((tree_.nodes[i].*side)->name.empty(), tree_.nodes[i].level); };
      return rank(a) < rank(b);
    });
    std::set<const FieldNode*> done;
    for (const size_t i : order) {
      const FieldPtr& node = tree_.nodes[i].*side;
      if (!done.insert(node.get()).second) continue;
      const Box3d box = in_space_of_root(tree_, i, warp, frame_, {box_of_tree(*node, frame_)}).front();
      end.labels.push_back({box.centre(), name_of(*node)});
    }
  }

  static std::string title_of(const NodeMatch& m) {
    if (!m.to) return fmt::format("{} shrinks", name_of(*m.from));
    if (!m.from) return fmt::format("{} grows", name_of(*m.to));
    const std::string difference = m.difference ? fmt::format(", difference {:.3g}", *m.difference) : "";
    const auto share = [](size_t ways) { return ways > 1 ? fmt::format(" (1 of {})", ways) : ""; };
    return fmt::format("{}{} to {}{}{}{}", name_of(*m.from), share(m.from_ways), name_of(*m.to), share(m.to_ways),
                       m.by == MatchedBy::pair ? ", forced" : "", difference);
  }

  static constexpr double k_endless = 1e6;

  const TreeMatch& tree_;
  double frame_;
  std::vector<bool> has_below_;
  MatchDrawing drawing_;
};

/// From blue at the bottom of the beginning to red at its top, so that the end shows where what has come from.
MatchDrawing drawing_of(const MatchedLiquid& liquid) {
  constexpr double k_blue = 230;
  MatchDrawing drawing;
  Box3d box;
  for (const Blob& b : liquid.from) box.extend(Vec3d(b.centre));
  const std::vector<double> amounts = amounts_of(liquid);
  const auto ball = [](const Blob& b) { return Box3d{Vec3d(b.centre) - double(b.radius) / 2, Vec3d(b.centre) + double(b.radius) / 2}; };
  for (size_t i = 0; i < liquid.from.size(); ++i) {
    const double height = (double(liquid.from[i].centre.y) - box.lower.y) / std::max(box.extent().y, 1e-9);
    DrawnPart part;
    part.hue = k_blue * (1 - height), part.is_round = true;
    part.title = fmt::format("{:.2g} % of all", 100 * amounts[i]);
    part.pieces = {ball(liquid.from[i])};
    drawing.from.parts.push_back(part);
    part.pieces = {ball(liquid.to[i])};
    drawing.to.parts.push_back(std::move(part));
    drawing.links.push_back({i, i, std::sqrt(amounts[i]) * k_all_of_a_liquid / std::sqrt(double(liquid.from.size()))});
  }
  return drawing;
}

} // namespace

std::string match_picture(const MatchReport& r) {
  std::vector<MatchDrawing> drawings;
  for (const GrownTree& tree : r.trees) {
    const double frame = r.frame_of(tree);
    drawings.push_back(TreeDrawer(tree.match, frame).take());
    drawings.back().title =
        fmt::format("{}: animorphosis of {}, frame {:.6g}", to_string(tree.root->where), fmt::join(tree.shapes, ", "), frame);
  }
  for (const MatchedLiquid& liquid : r.liquids) {
    drawings.push_back(drawing_of(liquid));
    drawings.back().title = title_of(liquid);
  }
  return svg_of(drawings);
}

} // namespace kelpie
