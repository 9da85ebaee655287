// Ways through two bodies of liquid, from each blob of one cloud to each of another.
#pragma once

#include <cstdint>
#include <vector>

#include "field/potential/blob.h"

namespace kelpie {

/// The blobs of both clouds as a graph: blobs that lie well in each other are joined by an edge as long as their centres are apart, those
/// between which there is a little air by a dearer one. What is still apart is joined where it is nearest. So a way between two blobs
/// leads through the bodies, along their limbs, and only where it must through the air.
///
/// Bodies whose boxes do not meet are laid upon each other first, centre of mass upon centre of mass.
class BodyGraph {
public:
  /// Neither cloud may be empty. Finds all shortest ways (Dijkstra's algorithm from each blob of `from`, on several threads; the result
  /// does not depend on their number). Takes memory in proportion to the product of the clouds' sizes.
  BodyGraph(const BlobCloud& from, const BlobCloud& to);

  /// Of the shortest way from blob i of `from` to blob j of `to`: scene units, where air counts k_air times.
  double length(size_t i, size_t j) const { return lengths_[i * to_count_ + j]; }

  /// The centres on that way: the first is that of blob i, the last that of blob j, where it is in its own cloud.
  std::vector<Vec3d> way(size_t i, size_t j) const;

  /// How many times longer a way through air is than one through a body.
  static constexpr double k_air = 6;

private:
  struct Edge {
    uint32_t node;
    double length;
  };
  struct Node {
    Vec3d centre{0};
    Blob blob;
    double radius = 0; ///< of its own surface, in radii of influence

    /// Of the blob, and of its own surface.
    double reach(const Vec3d& direction) const { return reach_towards(blob, direction); }
    double extent(const Vec3d& direction) const { return radius * reach(direction); }
  };
  void add_nodes(const BlobCloud&, const Vec3d& shift);
  void add_edges();
  void join_components();
  void add_edge(uint32_t a, uint32_t b, double length) { edges_[a].push_back({b, length}), edges_[b].push_back({a, length}); }
  std::vector<uint32_t> components() const;
  void find_ways(size_t source);

  size_t from_count_ = 0, to_count_ = 0;
  std::vector<Node> nodes_; ///< of `from`, then of `to`
  std::vector<std::vector<Edge>> edges_;
  std::vector<double> lengths_;      ///< [i * to_count + j]
  std::vector<uint32_t> comes_from_; ///< [i * nodes + node]: the node before it on the way from i
  Vec3d shift_{0};                   ///< by which `to` was moved
};

} // namespace kelpie
