#include "morph/tree/generic_tree.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include <fmt/format.h>

#include "base/suggest.h"
#include "morph/tree/computed.h"
#include "morph/tree/correspondence.h"
#include "morph/tree/leaf_between.h"
#include "morph/tree/mix_materials.h"
#include "morph/tree/neutral.h"

namespace kelpie {

namespace {

using A = AnimatedMode;

/// Of the children of two operators: an assignment takes their number to the power of three halves.
constexpr size_t k_most_comparisons = 1'000'000;
constexpr size_t k_most_pairs = 500;

/// How far a part has come, and which of the pairs says so: 0 is the whole, i is pair i - 1. Of the same number the progress is the same.
struct Progress {
  Animated<float> s; ///< it may leave [0, 1]: places and directions overshoot then…
  size_t of_pair = 0;

  Animated<float> held() const { return kelpie::held(s); } ///< …and this is for all else
};

FieldPtr node_of(AnimatedKind kind, const FieldNode& like) {
  return std::make_shared<FieldNode>(FieldNode{std::move(kind), like.where, like.material, like.name});
}

class Builder {
public:
  /// Parts are compared as they are at `frame`; what has no material is made of `material`.
  Builder(const Animorphosis<A>& kind, double frame, const MaterialPtr& material, const SourcePosition& where)
      : kind_(kind), pairs_(kind.pairs), frame_(frame), material_(material), where_(where) {}

  /// a at s = 0, b at s = 1.
  FieldPtr build(const FieldPtr& a, const FieldPtr& b, const Progress& progress) { return build(a, b, progress, {.from = a, .to = b}); }

  TreeMatch match() { return {frame_, log_.take()}; }

  void check_pairs() const {
    for (size_t i = 0; i < pairs_.size(); ++i)
      if (!met_.count(i))
        throw Error(
            ExitStatus::bad_data,
            fmt::format("pairs: \"{}\" and \"{}\" cannot correspond: what they stand in does not, or they stand at different levels",
                        pairs_[i].from, pairs_[i].to),
            pairs_[i].where);
  }

private:
  /// The same, logged as `match`.
  FieldPtr build(const FieldPtr& a, const FieldPtr& b, Progress progress, NodeMatch match) {
    for (size_t i = 0; i < pairs_.size(); ++i)
      if (is_called(*a, pairs_[i].from) && is_called(*b, pairs_[i].to)) {
        met_.insert(i), match.by = MatchedBy::pair;
        if (pairs_[i].progress) progress = {*pairs_[i].progress, i + 1};
      }
    log_.open(std::move(match));
    const bool are_leaves = children_of(*a).empty() && children_of(*b).empty();
    FieldPtr out = are_leaves                   ? leaf_between(*a, *b, progress.s, material_between(*a, *b, progress), frame_)
                   : is_warp(*a) || is_warp(*b) ? warps(a, b, progress)
                                                : operators(a, b, progress);
    const NodeFate fate = out ? NodeFate::becomes : NodeFate::exchanged;
    if (!out) out = exchange(a, b, progress.held());
    log_.close(fate, *out);
    return out;
  }

  static bool is_called(const FieldNode& node, std::string_view name) { return node.name == name; }
  static bool has_below(const FieldNode& node, std::string_view name) {
    const std::vector<FieldPtr> children = children_of(node);
    return is_called(node, name) || std::any_of(children.begin(), children.end(), [&](const FieldPtr& c) { return has_below(*c, name); });
  }

  // --- materials ---

  /// Of a node that was made of two: each once, however many nodes have it. None where neither has one.
  MaterialPtr material_between(const FieldNode& a, const FieldNode& b, const Progress& progress) {
    if (a.material == b.material) return a.material;
    const MaterialPtr &from = a.material ? a.material : material_, &to = b.material ? b.material : material_;
    MaterialPtr& mixed = materials_[{from.get(), to.get(), progress.of_pair}];
    if (!mixed) mixed = mixed_material(from, to, progress.held(), kind_.materials, frame_);
    return mixed;
  }

  // --- warps ---

  static bool is_warp(const FieldNode& node) {
    return std::visit(
        []<class Kind>(const Kind&) {
          return requires(const Kind& k) {
            { k.child } -> std::convertible_to<FieldPtr>;
          };
        },
        node.kind);
  }
  static FieldPtr with_child(AnimatedKind kind, const FieldNode& like, FieldPtr child) {
    std::visit(
        [&](auto& k) {
          if constexpr (requires { k.child = child; }) k.child = child;
        },
        kind);
    return node_of(std::move(kind), like);
  }

  /// Two of one kind become one another; any other starts from where it does nothing, or ends there. Null where that cannot be.
  FieldPtr warps(const FieldPtr& a, const FieldPtr& b, const Progress& progress) {
    if (is_warp(*a) && is_warp(*b))
      if (const auto kind = mixed_kind(a->kind, b->kind, progress.s))
        return above(*kind, *a, *b, build_below(a, b, children_of(*a)[0], children_of(*b)[0], progress), progress);
    const bool takes_a = is_warp(*a);
    const FieldPtr& warp = takes_a ? a : b;
    const std::optional<AnimatedKind> neutral = neutral_warp(warp->kind);
    const auto kind = !neutral  ? std::nullopt
                      : takes_a ? mixed_kind(warp->kind, *neutral, progress.s)
                                : mixed_kind(*neutral, warp->kind, progress.s);
    if (!kind) return nullptr;
    FieldPtr other = takes_a ? b : a; // below the warp, where what it is made of is said by the warp, if that says so
    if (warp->material) other = std::make_shared<FieldNode>(FieldNode{other->kind, other->where, nullptr, other->name});
    const FieldPtr below = children_of(*warp)[0];
    FieldPtr child = takes_a ? build_below(a, nullptr, below, other, progress) : build_below(nullptr, b, other, below, progress);
    if (!warp->material) return above(*kind, *warp, *warp, std::move(child), progress);
    return above(*kind, *a, *b, std::move(child), progress);
  }

  /// What is made of two nodes of which one, or each, has been come to through a warp.
  FieldPtr build_below(const FieldPtr& from_warp, const FieldPtr& to_warp, const FieldPtr& a, const FieldPtr& b, const Progress& progress) {
    return build(a, b, progress, {.from = a, .to = b, .from_warp = from_warp, .to_warp = to_warp});
  }

  /// A warp that was made of two nodes, of which one may be no warp.
  FieldPtr above(const AnimatedKind& warp, const FieldNode& a, const FieldNode& b, FieldPtr child, const Progress& progress) {
    FieldPtr out = with_child(warp, a, std::move(child));
    out->material = material_between(a, b, progress);
    return out;
  }

  // --- operators ---

  /// Whether a Boolean has the smooth formula.
  static bool is_smooth(const AnimatedKind& kind) {
    return std::visit(
        [](const auto& k) {
          if constexpr (requires { k.formula; }) return k.formula == BooleanFormula::smooth;
          return false;
        },
        kind);
  }

  /// An operator that both sides have in common, and what stands in it on each side.
  struct Common {
    AnimatedKind kind;
    std::vector<FieldPtr> from, to;
    FieldPtr region; ///< of a local blend, if it is neither side's
  };

  /// A blend is a local blend everywhere, a union one nowhere: where those of one side blend, and how much, goes to the region of the
  /// other. Null of other operators, and where the region cannot be weighted.
  static FieldPtr region_between(const FieldNode& other, const LocalBlend<A>& local, const Animated<float>& how_local) {
    const std::optional<Animated<float>> n = one_over_n(other);
    if (!n || std::holds_alternative<HyperBlend<A>>(other.kind)) return nullptr;
    FieldPtr region = weighted_tree(*local.region, how_local);
    if (!region || std::holds_alternative<Union<A>>(other.kind)) return region;
    Point<A> everywhere; // no place is far from its middle; above 1 a region counts as 1
    everywhere.radius = 1e9f;
    everywhere.weight = computed<float>([](float t) { return std::min(1.f, 1 - t) * 1.0001f; }, how_local);
    return node_of(Blend<A>{{region, node_of(everywhere, *region)}}, *region);
  }
  static std::optional<Common> common_with_local(const FieldPtr& a, const FieldPtr& b, const Animated<float>& s) {
    const auto *local_a = std::get_if<LocalBlend<A>>(&a->kind), *local_b = std::get_if<LocalBlend<A>>(&b->kind);
    if (!local_a == !local_b) return {};
    FieldPtr region = local_a ? region_between(*b, *local_a, rest_of(s)) : region_between(*a, *local_b, s);
    if (!region) return {};
    return Common{local_a ? a->kind : b->kind, children_of(*a), children_of(*b), std::move(region)};
  }

  /// Whether a leaf has a weight below 0 at some time.
  static bool may_carve(const FieldNode& node) {
    const auto own = [](const auto& kind) {
      if constexpr (requires { kind.weight.frames(); }) {
        const std::vector<double> frames = kind.weight.frames();
        if (frames.empty()) return kind.weight.at(0) < 0;
        return std::any_of(frames.begin(), frames.end(), [&](double frame) { return kind.weight.at(frame) < 0; });
      }
      return false;
    };
    const std::vector<FieldPtr> children = children_of(node);
    return std::visit(own, node.kind) || std::any_of(children.begin(), children.end(), [](const FieldPtr& c) { return may_carve(*c); });
  }

  /// 1/n of a hyper-blend that an operator is.
  static std::optional<Animated<float>> one_over_n(const FieldNode& node) {
    if (std::holds_alternative<Blend<A>>(node.kind)) { // a hyper-blend counts what carves as 0
      const std::vector<FieldPtr> children = children_of(node);
      if (std::any_of(children.begin(), children.end(), [](const FieldPtr& c) { return may_carve(*c); })) return {};
      return Animated<float>(1.f);
    }
    if (const auto* hyper = std::get_if<HyperBlend<A>>(&node.kind)) return computed<float>([](float n) { return 1 / n; }, hyper->n);
    const auto* united = std::get_if<Union<A>>(&node.kind);
    if (united && united->formula == BooleanFormula::sharp) return Animated<float>(0.f);
    return {};
  }

  static std::optional<Common> common(const FieldPtr& a, const FieldPtr& b, const Animated<float>& s) {
    const bool is_operator_a = !children_of(*a).empty() && !is_warp(*a), is_operator_b = !children_of(*b).empty() && !is_warp(*b);
    if (is_operator_a && is_operator_b) {
      if (const auto kind = mixed_kind(a->kind, b->kind, s)) return Common{*kind, children_of(*a), children_of(*b), nullptr};
      const auto n_a = one_over_n(*a), n_b = one_over_n(*b);
      if (n_a && n_b) {
        static constexpr float k_union = 1e-6f; // as good as 0
        const auto n = computed<float>([](float x, float y, float t) { return 1 / std::max(k_union, (1 - t) * x + t * y); }, *n_a, *n_b, s);
        return Common{HyperBlend<A>{n, {}}, children_of(*a), children_of(*b), nullptr};
      }
      if (auto local = common_with_local(a, b, s)) return local;
    }
    // One side stands alone in the operator of the other; what carves or joins locally is nearer to a lone part than a sum is.
    // Any but a blend counts what carves as 0.
    const auto can_hold = [](const FieldNode& node, const FieldNode& lone) {
      return !std::holds_alternative<Intersection<A>>(node.kind) && (std::holds_alternative<Blend<A>>(node.kind) || !may_carve(lone));
    };
    const bool takes_a = is_operator_a && can_hold(*a, *b), takes_b = is_operator_b && can_hold(*b, *a);
    const bool prefers_b = takes_b && one_over_n(*a) && !one_over_n(*b);
    if (takes_a && !prefers_b) return Common{a->kind, children_of(*a), {b}, nullptr};
    if (takes_b) return Common{b->kind, {a}, children_of(*b), nullptr};
    return {};
  }

  FieldPtr operators(const FieldPtr& a, const FieldPtr& b, const Progress& progress) {
    std::optional<Common> both = common(a, b, progress.held());
    if (!both || std::holds_alternative<Metamorphosis<A>>(both->kind)) return nullptr;
    // Nothing is all of space, and a smooth Boolean with one operand more, even an empty one, is another field.
    const bool needs_equals =
        std::holds_alternative<Intersection<A>>(both->kind) || (std::holds_alternative<Difference<A>>(both->kind) && is_smooth(both->kind));
    if (needs_equals && both->from.size() != both->to.size()) return nullptr;
    const std::vector<PartLink> wanted = forced(both->from, both->to);
    const bool is_out_of_order = std::any_of(wanted.begin(), wanted.end(), [](const PartLink& l) { return l.from != l.to; });
    if (is_smooth(both->kind) && is_out_of_order) return nullptr; // of three operands or more the order counts
    FieldPtr region;                                              // the last child of a local blend
    if (std::holds_alternative<LocalBlend<A>>(both->kind)) {
      const bool has_a = std::holds_alternative<LocalBlend<A>>(a->kind), has_b = std::holds_alternative<LocalBlend<A>>(b->kind);
      const FieldPtr region_a = has_a ? both->from.back() : nullptr, region_b = has_b ? both->to.back() : nullptr;
      if (has_a) both->from.pop_back();
      if (has_b) both->to.pop_back();
      region = both->region ? both->region : has_a && has_b ? build(region_a, region_b, progress) : has_a ? region_a : region_b;
    }
    const bool is_ordered = std::holds_alternative<Difference<A>>(both->kind);
    std::vector<FieldPtr> children;
    if (is_ordered) { // what is carved, and what carves
      children.push_back(build(both->from.front(), both->to.front(), progress));
      both->from.erase(both->from.begin()), both->to.erase(both->to.begin());
    }
    join(children, *both, progress);
    set_children(both->kind, std::move(children), region);
    FieldPtr out = node_of(std::move(both->kind), *a);
    out->material = nullptr;
    return out;
  }

  static void set_children(AnimatedKind& kind, std::vector<FieldPtr> children, const FieldPtr& region) {
    std::visit(
        [&](auto& k) {
          if constexpr (requires { k.children = children; }) k.children = children;
          if constexpr (requires { k.region = region; }) k.region = region;
        },
        kind);
  }

  std::vector<MatchedPart> parts_of(const std::vector<FieldPtr>& nodes) const {
    std::vector<MatchedPart> parts;
    for (const FieldPtr& node : nodes) {
      const size_t leaves = leaf_count(*node);
      parts.push_back({node.get(), box_of_tree(*node, frame_), leaves, colours_of(*node, material_) / float(leaves)});
    }
    return parts;
  }
  /// The sum of those of all leaves; `above`: what they are made of if nothing else says so.
  Vec3 colours_of(const FieldNode& node, const MaterialPtr& above) const {
    const MaterialPtr& material = node.material ? node.material : above;
    const std::vector<FieldPtr> children = children_of(node);
    if (children.empty()) return mean_colour(*material, frame_);
    Vec3 sum(0);
    for (const FieldPtr& child : children) sum += colours_of(*child, material);
    return sum;
  }

  std::vector<PartLink> forced(const std::vector<FieldPtr>& from, const std::vector<FieldPtr>& to) const {
    std::vector<PartLink> links;
    for (const NodePair<A>& pair : pairs_) { // a name is that of one node
      const auto i = std::find_if(from.begin(), from.end(), [&](const FieldPtr& part) { return has_below(*part, pair.from); });
      const auto j = std::find_if(to.begin(), to.end(), [&](const FieldPtr& part) { return has_below(*part, pair.to); });
      if (i == from.end() || j == to.end()) continue;
      const PartLink link{size_t(i - from.begin()), size_t(j - to.begin())};
      if (std::find(links.begin(), links.end(), link) == links.end()) links.push_back(link);
    }
    return links;
  }

  void join(std::vector<FieldPtr>& children, const Common& both, const Progress& progress) {
    if (both.from.size() * both.to.size() > k_most_comparisons)
      throw Error(ExitStatus::bad_data,
                  fmt::format("animorphosis: operators of {} and {} parts are too many to match", both.from.size(), both.to.size()),
                  where_);
    const std::vector<MatchedPart> from = parts_of(both.from), to = parts_of(both.to);
    const std::vector<PartLink> pairs = forced(both.from, both.to);
    const bool keeps_order = is_smooth(both.kind);
    std::vector<PartLink> links = keeps_order ? links_in_order(from.size(), to.size()) : match_children(from, to, pairs);
    const size_t undivided = links.size();
    if (one_over_n(FieldNode{both.kind, {}, {}, {}})) divide_leaves(links, from, to);
    const auto ways = [&](auto side, size_t i) {
      return size_t(std::count_if(links.begin(), links.end(), [&](const PartLink& l) { return l.*side == i; }));
    };
    const Box3d around_from = box_around(from), around_to = box_around(to);
    for (size_t l = 0; l < links.size(); ++l) {
      const auto [i, j] = links[l];
      const bool is_forced = std::find(pairs.begin(), pairs.end(), links[l]) != pairs.end();
      const NodeMatch match{.from = both.from[i],
                            .to = both.to[j],
                            .by = l >= undivided ? MatchedBy::division
                                  : is_forced    ? MatchedBy::pair
                                  : keeps_order  ? MatchedBy::place
                                                 : MatchedBy::difference,
                            .difference = difference_of(from[i], to[j], around_from, around_to),
                            .from_ways = ways(&PartLink::from, i),
                            .to_ways = ways(&PartLink::to, j)};
      children.push_back(build(share(match.from, match.from_ways, both.kind), share(match.to, match.to_ways, both.kind), progress, match));
    }
    for (size_t i = 0; i < from.size(); ++i)
      if (!ways(&PartLink::from, i))
        children.push_back(loose(NodeFate::shrinks, both.from[i], anchor_of(from[i], from, to, links, &PartLink::from), progress.held()));
    for (size_t j = 0; j < to.size(); ++j)
      if (!ways(&PartLink::to, j))
        children.push_back(loose(NodeFate::grows, both.to[j], anchor_of(to[j], to, from, links, &PartLink::to), rest_of(progress.held())));
  }

  /// Whether the field of a tree is multiplied when the weights of its leaves are: nothing in it looks at the threshold.
  static bool is_linear(const FieldNode& node) {
    if (std::holds_alternative<Difference<A>>(node.kind) || is_smooth(node.kind)) return false;
    const std::vector<FieldPtr> children = children_of(node);
    return std::all_of(children.begin(), children.end(), [](const FieldPtr& c) { return is_linear(*c); });
  }

  /// A part that goes several ways: its copies together are what it was. In a hyper-blend n copies of weight w / n^(1/n') are one.
  FieldPtr share(const FieldPtr& node, size_t ways, const AnimatedKind& in) const {
    if (ways < 2) return node;
    const auto refuse = [&] {
      throw Error(ExitStatus::bad_data, fmt::format("pairs: \"{}\" cannot be divided where it stands, or cannot be weighted", node->name),
                  where_);
    };
    const bool is_blend = one_over_n(FieldNode{in, {}, {}, {}}).has_value();
    if (!is_blend && (!std::holds_alternative<Difference<A>>(in) || is_smooth(in))) refuse();
    if (std::holds_alternative<Union<A>>(in) || std::holds_alternative<Difference<A>>(in)) return node;
    const auto* hyper = std::get_if<HyperBlend<A>>(&in);
    const auto part =
        computed<float>([ways](float n) { return float(std::pow(double(ways), -1 / double(n))); }, hyper ? hyper->n : Animated<float>(1.f));
    FieldPtr copy = is_linear(*node) ? weighted_tree(*node, part) : nullptr;
    if (!copy) refuse();
    return copy;
  }

  /// A part that is whole at s = 0 and gone at s = 1: it draws in to a place, goes with its neighbour, and at last loses its weight.
  static FieldPtr shrunk(const FieldPtr& node, const Anchor& to, const Animated<float>& s) {
    static constexpr float k_least = 0.02f, k_least_unfaded = 1e-4f, k_fading = 0.1f;
    const auto left = computed<float>([](float t) { return std::min(1.f, (1 - t) / k_fading); }, s);
    const FieldPtr faded = weighted_tree(*node, left); // null of what has no weight: that becomes very small
    const float least = faded ? k_least : k_least_unfaded;
    const auto size = computed<Vec3>([least](float t) { return Vec3(std::max(least, 1 - t)); }, s);
    const FieldPtr scaled = node_of(Scale<A>{size, to.place, faded ? faded : node}, *node);
    const auto by = computed<Vec3>([drift = to.drift](float t) { return drift * t; }, s);
    FieldPtr out = node_of(Translate<A>{by, scaled}, *node);
    out->material = scaled->material = nullptr;
    return out;
  }

  /// Without a counterpart; `s` as shrunk() has it.
  FieldPtr loose(NodeFate fate, const FieldPtr& node, const Anchor& to, const Animated<float>& s) {
    log_.open(fate == NodeFate::shrinks ? NodeMatch{.from = node, .place = to.place} : NodeMatch{.to = node, .place = to.place});
    FieldPtr out = shrunk(node, to, s);
    log_.close(fate, *out);
    return out;
  }

  /// What have nothing in common: the one goes while the other comes, in one place that moves from that of the one to that of the other.
  FieldPtr exchange(const FieldPtr& a, const FieldPtr& b, const Animated<float>& s) const {
    const Box3d box_a = box_of_tree(*a, frame_), box_b = box_of_tree(*b, frame_);
    const Vec3 drift = drift_between(box_a, box_b);
    std::vector<FieldPtr> both{shrunk(a, {Vec3(box_a.centre()), drift}, s), shrunk(b, {Vec3(box_b.centre()), -drift}, rest_of(s))};
    const bool is_sum = may_carve(*a) || may_carve(*b); // a union would count that as 0
    FieldPtr out = is_sum ? node_of(Blend<A>{std::move(both)}, *a) : node_of(Union<A>{BooleanFormula::sharp, std::move(both)}, *a);
    out->material = nullptr;
    return out;
  }

  const Animorphosis<A>& kind_;
  const std::vector<NodePair<A>>& pairs_;
  double frame_;
  MaterialPtr material_;
  SourcePosition where_;
  std::map<std::tuple<const MaterialNode*, const MaterialNode*, size_t>, MaterialPtr> materials_;
  std::set<size_t> met_; ///< of pairs_
  MatchLog log_;
};

void collect_names(const FieldNode& node, std::vector<std::string_view>& names) {
  if (!node.name.empty()) names.push_back(node.name);
  for (const FieldPtr& child : children_of(node)) collect_names(*child, names);
}

void check_name(const std::string& name, const FieldNode& tree, std::string_view side, const SourcePosition& where) {
  std::vector<std::string_view> names;
  collect_names(tree, names);
  const auto count = std::count(names.begin(), names.end(), name);
  if (count == 1) return;
  const std::string problem = count > 1       ? fmt::format("{} nodes are called \"{}\"", count, name)
                              : names.empty() ? fmt::format("no node is called \"{}\", as none has a name", name)
                                              : fmt::format("no node is called \"{}\"{}", name, suggestion(name, names));
  throw Error(ExitStatus::bad_data, fmt::format("pairs: in `{}` {}", side, problem), where);
}

/// Half way through the morph.
double middle_frame(const Animated<float>& progress) {
  const std::vector<double> frames = progress.frames();
  return frames.empty() ? 1 : 0.5 * (frames.front() + frames.back());
}

} // namespace

GenericTree generic_tree(const Animorphosis<A>& kind, const TreePlace& place, const SourcePosition& where) {
  const FieldPtr from = plain_tree(*kind.from, place), to = plain_tree(*kind.to, place);
  if (kind.pairs.size() > k_most_pairs) throw Error(ExitStatus::bad_data, fmt::format("pairs: more than {}", k_most_pairs), where);
  for (const NodePair<A>& pair : kind.pairs) check_name(pair.from, *from, "from", pair.where), check_name(pair.to, *to, "to", pair.where);
  Builder builder(kind, middle_frame(kind.progress), place.material, where);
  FieldPtr root = builder.build(from, to, {kind.progress});
  builder.check_pairs();
  return {std::move(root), builder.match()};
}

} // namespace kelpie
