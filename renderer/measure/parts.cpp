#include "renderer/measure/parts.h"

#include <algorithm>
#include <map>
#include <numeric>

namespace kelpie {

namespace {

/// Union-find with halved paths; the smallest member stands for a set.
class DisjointSets {
public:
  explicit DisjointSets(size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0u); }

  uint32_t find(uint32_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void join(uint32_t a, uint32_t b) {
    a = find(a), b = find(b);
    parent_[std::max(a, b)] = std::min(a, b);
  }

private:
  std::vector<uint32_t> parent_;
};

/// Numbers the parts in the order of their first nodes.
size_t label_nodes(const Isosurface& surface, const Lattice& lattice, std::vector<uint32_t>& of_node) {
  const size_t count = lattice.node_count();
  DisjointSets sets(count);
  // Nodes on the hull of the lattice are outside, so no stride leads from one row into the next.
  for (unsigned direction = 1; direction < 8; ++direction) {
    const size_t stride = lattice.stride(direction);
    for (size_t i = 0; i + stride < count; ++i)
      if (surface.inside[i] && surface.inside[i + stride]) sets.join(uint32_t(i), uint32_t(i + stride));
  }
  of_node.assign(count, Parts::k_outside);
  uint32_t parts = 0;
  for (size_t i = 0; i < count; ++i) {
    if (!surface.inside[i]) continue;
    const uint32_t first = sets.find(uint32_t(i));
    of_node[i] = first == i ? parts++ : of_node[first];
  }
  return parts;
}

/// One closed surface.
struct Shell {
  int vertices = 0, triangles = 0;
};

/// Adds what the surface says of each part.
void measure(const Isosurface& surface, const std::vector<uint32_t>& of_node, std::vector<Part>& parts) {
  const Mesh& mesh = surface.mesh;
  DisjointSets shells(mesh.positions.size());
  for (const Triangle& t : mesh.triangles) {
    shells.join(t[0], t[1]), shells.join(t[1], t[2]);
    const Vec3d &a = mesh.positions[t[0]], &b = mesh.positions[t[1]], &c = mesh.positions[t[2]];
    Part& part = parts[of_node[surface.inner[t[0]]]];
    const double cone = glm::dot(a, glm::cross(b, c)) / 6; // from the origin
    part.volume += cone, part.centre += cone * 0.25 * (a + b + c);
    part.area += 0.5 * glm::length(glm::cross(b - a, c - a));
  }
  std::map<uint32_t, Shell> found;
  for (uint32_t v = 0; v < mesh.positions.size(); ++v) ++found[shells.find(v)].vertices;
  for (const Triangle& t : mesh.triangles) ++found[shells.find(t[0])].triangles;
  for (Part& part : parts) part.cavities = -1; // the outer surface is none
  for (const auto& [first, shell] : found) {
    Part& part = parts[of_node[surface.inner[first]]];
    const int euler = shell.vertices - shell.triangles / 2; // a triangle has three halves of an edge
    part.genus += 1 - euler / 2, ++part.cavities;
  }
}

/// The overlaps of parts of two frames: nodes that are in both.
using Overlaps = std::map<std::pair<size_t, size_t>, size_t>;

Overlaps overlaps_of(const Parts& earlier, const Parts& later) {
  Overlaps found;
  for (size_t i = 0; i < later.of_node.size(); ++i)
    if (earlier.of_node[i] != Parts::k_outside && later.of_node[i] != Parts::k_outside) ++found[{earlier.of_node[i], later.of_node[i]}];
  return found;
}

double radius_of(const Part& part) { return std::cbrt(part.volume * 3 / (4 * 3.14159265358979323846)); }

/// Pairs what overlaps nothing with what it may have become, the nearest first.
void pair_by_distance(const Parts& earlier, const Parts& later, Overlaps& overlaps) {
  constexpr double k_reach = 6, k_most_growth = 2; // in radii; in volume
  std::vector<bool> has_later(earlier.parts.size()), has_earlier(later.parts.size());
  for (const auto& [pair, nodes] : overlaps) has_later[pair.first] = has_earlier[pair.second] = true;
  std::vector<std::tuple<double, size_t, size_t>> near;
  for (size_t a = 0; a < earlier.parts.size(); ++a)
    for (size_t b = 0; b < later.parts.size(); ++b) {
      const Part &p = earlier.parts[a], &q = later.parts[b];
      const double distance = glm::length(p.centre - q.centre);
      const bool is_alike = p.volume < k_most_growth * q.volume && q.volume < k_most_growth * p.volume;
      if (!has_later[a] && !has_earlier[b] && is_alike && distance < k_reach * radius_of(p)) near.emplace_back(distance, a, b);
    }
  std::sort(near.begin(), near.end());
  for (const auto& [distance, a, b] : near) {
    if (has_later[a] || has_earlier[b]) continue;
    overlaps[{a, b}] = 1;
    has_later[a] = has_earlier[b] = true;
  }
}

/// For each earlier part the later one that it overlaps most, and the other way round.
struct Partners {
  std::vector<size_t> later_of, earlier_of;
};

Partners partners_of(const Overlaps& overlaps, size_t earlier, size_t later) {
  Partners p{std::vector<size_t>(earlier, PartLinks::k_none), std::vector<size_t>(later, PartLinks::k_none)};
  std::vector<size_t> most_later(earlier), most_earlier(later);
  for (const auto& [pair, nodes] : overlaps) {
    const auto [a, b] = pair;
    if (nodes > most_later[a]) most_later[a] = nodes, p.later_of[a] = b;
    if (nodes > most_earlier[b]) most_earlier[b] = nodes, p.earlier_of[b] = a;
  }
  return p;
}

void find_groups(const Overlaps& overlaps, const Parts& earlier, const Parts& later, PartLinks& links) {
  const size_t n = later.parts.size();
  DisjointSets sets(n + earlier.parts.size());
  for (const auto& [pair, nodes] : overlaps) sets.join(uint32_t(pair.second), uint32_t(n + pair.first));
  std::map<uint32_t, size_t> number;
  const auto group = [&](size_t i) {
    const auto [at, is_new] = number.try_emplace(sets.find(uint32_t(i)), links.groups.size());
    if (is_new) links.groups.emplace_back();
    return at->second;
  };
  for (size_t b = 0; b < n; ++b) {
    links.group_of.push_back(group(b));
    links.groups[links.group_of[b]].after += later.parts[b].volume;
  }
  for (size_t a = 0; a < earlier.parts.size(); ++a) links.groups[group(n + a)].before += earlier.parts[a].volume;
}

} // namespace

double Parts::volume() const {
  return std::accumulate(parts.begin(), parts.end(), 0.0, [](double sum, const Part& p) { return sum + p.volume; });
}

double Parts::area() const {
  return std::accumulate(parts.begin(), parts.end(), 0.0, [](double sum, const Part& p) { return sum + p.area; });
}

Parts find_parts(const Isosurface& surface, const Lattice& lattice) {
  Parts out;
  std::vector<Part> found(label_nodes(surface, lattice, out.of_node));
  measure(surface, out.of_node, found);
  for (Part& part : found)
    if (part.volume > 0) part.centre /= part.volume;
  std::vector<uint32_t> order(found.size()), rank(found.size());
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) { return found[a].volume > found[b].volume; });
  for (uint32_t i = 0; i < order.size(); ++i) rank[order[i]] = i, out.parts.push_back(found[order[i]]);
  for (uint32_t& part : out.of_node)
    if (part != Parts::k_outside) part = rank[part];
  return out;
}

PartLinks link_parts(const Parts& earlier, const Parts& later) {
  Overlaps overlaps = overlaps_of(earlier, later);
  pair_by_distance(earlier, later, overlaps);
  const Partners partners = partners_of(overlaps, earlier.parts.size(), later.parts.size());
  PartLinks links;
  using Kind = PartEvent::Kind;
  for (size_t a = 0; a < earlier.parts.size(); ++a) {
    const size_t b = partners.later_of[a];
    if (b != PartLinks::k_none && partners.earlier_of[b] == a) continue;
    const Part& part = earlier.parts[a];
    links.events.push_back({b == PartLinks::k_none ? Kind::vanishes : Kind::merges, part.centre, part.volume, a});
  }
  for (size_t b = 0; b < later.parts.size(); ++b) {
    const size_t a = partners.earlier_of[b];
    const bool goes_on = a != PartLinks::k_none && partners.later_of[a] == b;
    links.earlier_of.push_back(goes_on ? a : PartLinks::k_none);
    if (goes_on) continue;
    const Part& part = later.parts[b];
    links.events.push_back({a == PartLinks::k_none ? Kind::appears : Kind::parts, part.centre, part.volume, b});
  }
  find_groups(overlaps, earlier, later, links);
  return links;
}

} // namespace kelpie
