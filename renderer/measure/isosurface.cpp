#include "renderer/measure/isosurface.h"

#include <algorithm>
#include <unordered_map>

#include "base/parallel.h"
#include "renderer/program/surface_search.h"

namespace kelpie {

namespace {

constexpr uint32_t k_block = 8; ///< cells along each side of a block, at most

using Place = Lattice::Place;

/// The cells [first, last) of a lattice, with what matters there.
struct Block {
  Place first{}, last{};
  Code now, before, after; ///< of the programs of a FieldMoment

  uint32_t size(size_t axis) const { return last[axis] - first[axis]; }
};

/// Calls `visit(place)` for all places from `first` to `last`, without the last ones.
template <class Visit>
void for_each_place(const Place& first, const Place& last, Visit&& visit) {
  for (uint32_t z = first[2]; z < last[2]; ++z)
    for (uint32_t y = first[1]; y < last[1]; ++y)
      for (uint32_t x = first[0]; x < last[0]; ++x) visit(Place{x, y, z});
}

/// Finds the blocks through which the surface may pass, and marks the nodes of those that are full.
class BlockFinder {
public:
  BlockFinder(const FieldMoment& moment, const Lattice& lattice, std::vector<uint8_t>& inside)
      : moment_(moment), lattice_(lattice), inside_(inside) {}

  std::vector<Block> run() {
    divide({{0, 0, 0}, lattice_.cells, moment_.now.code, moment_.before.code, moment_.after.code});
    return std::move(blocks_);
  }

private:
  /// A block with the codes of what it is a part of.
  void divide(Block block) {
    Interval field;
    const Box3d box{lattice_.at(block.first), lattice_.at(block.last)};
    block.now = code_in(moment_.now, block.now, box, field);
    if (is_empty(field, moment_.now.threshold)) return;
    if (is_full(field, moment_.now.threshold)) {
      const Place end{block.last[0] + 1, block.last[1] + 1, block.last[2] + 1};
      for_each_place(block.first, end, [&](const Place& p) { inside_[lattice_.index(p)] = 1; });
      return;
    }
    Interval unused;
    block.before = code_in(moment_.before, block.before, box, unused);
    block.after = code_in(moment_.after, block.after, box, unused);
    size_t longest = 0;
    for (size_t axis = 1; axis < 3; ++axis)
      if (block.size(axis) > block.size(longest)) longest = axis;
    if (block.size(longest) <= k_block) {
      blocks_.push_back(std::move(block));
      return;
    }
    const uint32_t middle = block.first[longest] + block.size(longest) / 2;
    Block lower = block, upper = std::move(block);
    lower.last[longest] = upper.first[longest] = middle;
    divide(std::move(lower));
    divide(std::move(upper));
  }

  const FieldMoment& moment_;
  const Lattice& lattice_;
  std::vector<uint8_t>& inside_;
  std::vector<Block> blocks_;
};

/// The tetrahedra of a cell: corners as bits of x, y, z, on the six ways from corner 0 to corner 7.
constexpr std::array<std::array<unsigned, 4>, 6> k_tetrahedra{
    {{0, 1, 3, 7}, {0, 2, 3, 7}, {0, 1, 5, 7}, {0, 4, 5, 7}, {0, 2, 6, 7}, {0, 4, 6, 7}}};

Vec3d corner_place(unsigned corner) { return {corner & 1, corner >> 1 & 1, corner >> 2 & 1}; }

/// The piece of the surface in one block.
class BlockSurface {
public:
  struct Vertex {
    uint64_t edge = 0; ///< 8 times the index of its lower node, plus the direction to the upper one
    Vec3d position{0};
    uint32_t inner = 0;
    float speed = 0;
  };

  std::vector<Vertex> vertices;
  std::vector<Triangle> triangles;

  void run(const FieldMoment& moment, const Lattice& lattice, const Block& block, std::vector<uint8_t>& inside) {
    moment_ = &moment, lattice_ = &lattice, block_ = &block;
    const Place end{block.last[0] + 1, block.last[1] + 1, block.last[2] + 1};
    for_each_place(block.first, end, [&](const Place& p) { field_.push_back(excess(moment.now, block.now, lattice.at(p))); });
    for_each_place(block.first, block.last, [&](const Place& p) {
      inside[lattice.index(p)] = field_[local(p)] > 0; // the nodes beyond are those of the next block
      for (const auto& tetrahedron : k_tetrahedra) cut(p, tetrahedron);
    });
    known_.clear(), field_.clear();
  }

private:
  size_t local(const Place& p) const {
    const size_t x = p[0] - block_->first[0], y = p[1] - block_->first[1], z = p[2] - block_->first[2];
    return x + (block_->size(0) + 1) * (y + (block_->size(1) + 1) * z);
  }
  static Place corner_of(const Place& cell, unsigned corner) {
    return {cell[0] + (corner & 1), cell[1] + (corner >> 1 & 1), cell[2] + (corner >> 2 & 1)};
  }

  /// One corner on its own side makes a triangle, two a quadrangle.
  void cut(const Place& cell, const std::array<unsigned, 4>& tetrahedron) {
    std::array<unsigned, 4> in{}, out{};
    size_t ins = 0, outs = 0;
    for (const unsigned corner : tetrahedron)
      if (field_[local(corner_of(cell, corner))] > 0)
        in[ins++] = corner;
      else
        out[outs++] = corner;
    if (ins == 1) add(cell, {{{in[0], out[0]}, {in[0], out[1]}, {in[0], out[2]}}});
    if (ins == 3) add(cell, {{{in[0], out[0]}, {in[1], out[0]}, {in[2], out[0]}}});
    if (ins != 2) return;
    add(cell, {{{in[0], out[0]}, {in[0], out[1]}, {in[1], out[1]}}});
    add(cell, {{{in[0], out[0]}, {in[1], out[1]}, {in[1], out[0]}}});
  }

  struct Edge {
    unsigned in, out; ///< corners
  };

  /// Turned by the middles of its edges, which never coincide as its vertices may.
  void add(const Place& cell, const std::array<Edge, 3>& edges) {
    std::array<Vec3d, 3> middle;
    Vec3d outward(0);
    Triangle triangle;
    for (size_t i = 0; i < 3; ++i) {
      const Vec3d in = corner_place(edges[i].in), out = corner_place(edges[i].out);
      middle[i] = 0.5 * (in + out), outward += out - in;
      triangle[i] = vertex(cell, edges[i]);
    }
    if (glm::dot(glm::cross(middle[1] - middle[0], middle[2] - middle[0]), outward) < 0) std::swap(triangle[1], triangle[2]);
    triangles.push_back(triangle);
  }

  uint32_t vertex(const Place& cell, const Edge& edge) {
    const Place in = corner_of(cell, edge.in), out = corner_of(cell, edge.out);
    const unsigned lower = edge.in & edge.out, direction = edge.in ^ edge.out; // one of the two holds the other's bits
    const uint64_t key = 8 * uint64_t(lattice_->index(corner_of(cell, lower))) + direction;
    const auto [known, is_new] = known_.try_emplace(key, static_cast<uint32_t>(vertices.size()));
    if (is_new) {
      const Vec3d p = crossing_between(lattice_->at(in), field_[local(in)], lattice_->at(out), field_[local(out)]);
      vertices.push_back({key, p, static_cast<uint32_t>(lattice_->index(in)), speed(p)});
    }
    return known->second;
  }

  /// Where the field crosses the threshold between a (inside) and b.
  Vec3d crossing_between(const Vec3d& a, double at_a, const Vec3d& b, double at_b) const {
    constexpr double k_close = 1e-6; // of the threshold
    const FieldProgram& program = moment_->now;
    const auto excess_at = [&](double part) { return excess(program, block_->now, a + part * (b - a)); };
    return a + crossing(at_a, at_b, k_close * program.threshold, excess_at) * (b - a);
  }

  /// -F_t / |grad F| of F, the field minus the threshold.
  float speed(const Vec3d& p) const {
    const double slope = glm::length(gradient(moment_->now, CodeView(block_->now), p));
    const double change = excess(moment_->after, block_->after, p) - excess(moment_->before, block_->before, p);
    return slope > 0 ? static_cast<float>(std::abs(change) / moment_->span / slope) : 0.f;
  }

  const FieldMoment* moment_ = nullptr;
  const Lattice* lattice_ = nullptr;
  const Block* block_ = nullptr;
  std::vector<double> field_; ///< minus the threshold, at all nodes of the block
  std::unordered_map<uint64_t, uint32_t> known_;
};

/// Blocks share the vertices on their faces: the first one's count.
Isosurface joined(const std::vector<BlockSurface>& blocks, std::vector<uint8_t> inside) {
  Isosurface out;
  out.inside = std::move(inside);
  std::unordered_map<uint64_t, uint32_t> known;
  for (const BlockSurface& block : blocks) {
    std::vector<uint32_t> number;
    for (const BlockSurface::Vertex& v : block.vertices) {
      const auto [at, is_new] = known.try_emplace(v.edge, static_cast<uint32_t>(out.mesh.positions.size()));
      if (is_new) out.mesh.positions.push_back(v.position), out.inner.push_back(v.inner), out.speed.push_back(v.speed);
      number.push_back(at->second);
    }
    for (const Triangle& t : block.triangles) out.mesh.triangles.push_back({number[t[0]], number[t[1]], number[t[2]]});
  }
  return out;
}

} // namespace

Isosurface extract_surface(const FieldMoment& moment, const Lattice& lattice) {
  std::vector<uint8_t> inside(lattice.node_count());
  const std::vector<Block> blocks = BlockFinder(moment, lattice, inside).run();
  std::vector<BlockSurface> pieces(blocks.size());
  parallel_for(size_t(0), blocks.size(), [&](size_t i) { pieces[i].run(moment, lattice, blocks[i], inside); });
  return joined(pieces, std::move(inside));
}

} // namespace kelpie
