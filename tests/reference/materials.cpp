#include "tests/reference/materials.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace reference {

namespace {

using Kind = Node::Kind;

bool is_warp(Kind kind) {
  return kind == Kind::warp || kind == Kind::twist || kind == Kind::taper || kind == Kind::bend || kind == Kind::axial;
}

Vec below_warp(const Node& node, Vec p) {
  switch (node.kind) {
  case Kind::twist: return untwisted(node, p);
  case Kind::taper: return untapered(node, p);
  case Kind::bend: return unbent(node, p).p;
  case Kind::axial: return undeformed(*node.axial, p);
  default: return node.child_from_parent.point(p);
  }
}

/// The material in force, and where the point is for it.
struct Matter {
  int material;
  Vec at;
};

/// A summand of a blend: a leaf (no node), or an operator.
struct Term {
  double value;
  const Node* op;
  Vec p;
  Matter matter;
};

void find_terms(const Node& node, Vec p, Matter matter, double threshold, std::vector<Term>& out) {
  if (node.material >= 0) matter = {node.material, p};
  if (node.kind == Kind::leaves) {
    for (const Leaf& leaf : node.leaves) {
      Node alone;
      alone.leaves = {leaf};
      out.push_back({value(alone, p, threshold), nullptr, p, matter});
    }
  } else if (node.kind == Kind::blend) {
    for (const NodePtr& child : node.children) find_terms(*child, p, matter, threshold, out);
  } else if (is_warp(node.kind)) {
    find_terms(*node.children[0], below_warp(node, p), matter, threshold, out);
  } else {
    out.push_back({value(node, p, threshold), &node, p, matter});
  }
}

/// Of each child of an operator; the region of a local blend is the last.
std::vector<double> shares_of(const Node& node, Vec p, double threshold) {
  std::vector<double> f, shares;
  for (const NodePtr& child : node.children) f.push_back(value(*child, p, threshold));
  shares.assign(f.size(), 0);
  size_t best = 0;
  switch (node.kind) {
  case Kind::hyper_blend: {
    double sum = 0;
    for (const double x : f) sum += x > 0 ? std::pow(x, node.n) : 0;
    for (size_t i = 0; i < f.size(); ++i) shares[i] = f[i] > 0 ? std::pow(f[i], node.n) / sum : 0;
    return shares;
  }
  case Kind::local_blend: {
    const double region = std::clamp(f.back(), 0.0, 1.0);
    double sum = 0;
    for (size_t i = 0; i + 1 < f.size(); ++i) {
      sum += std::max(0.0, f[i]);
      if (f[i] > f[best]) best = i;
    }
    for (size_t i = 0; i + 1 < f.size(); ++i) shares[i] = (sum > 0 ? region * std::max(0.0, f[i]) / sum : 0) + (i == best ? 1 - region : 0);
    return shares;
  }
  case Kind::mix: {
    const Mix& mix = *node.mix;
    const size_t objects = mix.objects.size(), elements = f.size() - mix.features.size() * objects;
    std::vector<double> distances;
    for (size_t i = 0; i < elements; ++i) distances.push_back(f[i] / threshold - 1);
    const std::vector<double> weights = feature_weights(mix, distances);
    for (size_t i = 0; i < mix.features.size(); ++i) {
      std::vector<double> to_objects;
      for (size_t j = 0; j < objects; ++j) to_objects.push_back(mix.reach * (f[elements + i * objects + j] / threshold - 1));
      const std::vector<double> own = object_shares(mix, i, to_objects);
      for (size_t j = 0; j < objects; ++j) shares[elements + i * objects + j] = weights[i] * own[j];
    }
    return shares;
  }
  case Kind::unite:
  case Kind::r_unite: best = size_t(std::max_element(f.begin(), f.end()) - f.begin()); break;
  case Kind::intersect:
  case Kind::r_intersect: best = size_t(std::min_element(f.begin(), f.end()) - f.begin()); break;
  default: // without all but the first
    for (size_t i = 1; i < f.size(); ++i) f[i] = 2 * threshold - f[i];
    best = size_t(std::min_element(f.begin(), f.end()) - f.begin());
  }
  shares[best] = 1;
  return shares;
}

void find(const Node& node, Vec p, Matter matter, double threshold, double share, std::vector<MaterialPart>& out) {
  std::vector<Term> terms;
  find_terms(node, p, matter, threshold, terms);
  double sum = 0, total = 0;
  for (const Term& t : terms) sum += std::max(0.0, t.value), total += t.value;
  if (total <= 0) return; // there is nothing
  for (const Term& t : terms) {
    if (!(t.value > 0)) continue;
    const double part = share * t.value / sum;
    if (t.op) {
      const std::vector<double> shares = shares_of(*t.op, t.p, threshold);
      for (size_t i = 0; i < shares.size(); ++i)
        if (shares[i] > 0) find(*t.op->children[i], t.p, t.matter, threshold, part * shares[i], out);
    } else if (t.matter.material >= 0) {
      out.push_back({t.matter.material, part, t.matter.at});
    }
  }
}

} // namespace

std::vector<MaterialPart> materials(const Node& node, Vec p, double threshold) {
  std::vector<MaterialPart> out;
  find(node, p, {-1, {}}, threshold, 1, out);
  return out;
}

} // namespace reference
