// A field, compiled for one frame: a flat program in post-order.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <unordered_map>

#include "field/skeletons/hull_faces.h"
#include "scene/scene.h"

namespace kelpie {

/// The numbers of one blob. Its potential is q^2 (a + b q) with q = max(0, 1 - |p - (x, y, z)|^2 k); of an ellipsoid
/// q = max(0, 1 - |shape (p - (x, y, z))|^2).
struct BlobNumbers {
  float x, y, z, k, a, b;
  SymmetricMat3 shape{};
};

/// The shapes of a program's blobs: they take what is seen from a centre into the unit ball.
struct BlobShapes {
  std::vector<float> xx, yy, zz, xy, xz, yz;

  static constexpr std::array k_members{&BlobShapes::xx, &BlobShapes::yy, &BlobShapes::zz,
                                        &BlobShapes::xy, &BlobShapes::xz, &BlobShapes::yz};
  void push(const SymmetricMat3&);
  SymmetricMat3 operator[](uint32_t i) const { return {xx[i], yy[i], zz[i], xy[i], xz[i], yz[i]}; }

  friend bool operator==(const BlobShapes&, const BlobShapes&) = default;
};

/// The blobs of a program in structure-of-arrays form: the weight is folded into the falloff's polynomial.
struct BlobArrays {
  std::vector<float> x, y, z, a, b;
  std::vector<float> radius; ///< the farthest that each reaches
  std::vector<float> k;      ///< 1 / radius^2
  std::vector<float> least;  ///< the shortest half axis of each ellipsoid; only if they have shapes
  BlobShapes shapes;
  bool has_shapes = false; ///< some may be ellipsoids

  size_t size() const { return x.size(); }
  bool are_round() const { return !has_shapes; }
  void push(const Blob&);
  float least_radius(uint32_t i) const { return are_round() ? radius[i] : least[i]; }
  BlobNumbers operator[](uint32_t i) const { return {x[i], y[i], z[i], k[i], a[i], b[i], are_round() ? SymmetricMat3{} : shapes[i]}; }
  /// Calls visit(numbers) for each list of numbers that there is.
  template <class Visit>
  void for_each_list(Visit&& visit) {
    for (auto* list : {&x, &y, &z, &a, &b, &radius, &k}) visit(*list);
    if (are_round()) return;
    visit(least);
    for (const auto member : BlobShapes::k_members) visit(shapes.*member);
  }

  /// Makes balls ellipsoids, so that they may be listed with such.
  void give_shapes();
};

/// Blobs on their way from one list to another.
struct BlobsBetween {
  const BlobArrays* start = nullptr;
  const BlobArrays* end = nullptr;
  float part = 0; ///< of the way
};

/// One step of a program; its value is stored at its own position.
struct Instruction {
  enum class Kind : uint32_t {
    blobs,    ///< the sum of blobs  [first, first + count) of the blob list; 0 if count is 0
    skeleton, ///< the potential of the skeleton `node`
    combine,  ///< the operator `node` on the values of the steps [first, first + count) of the operand list
  };
  Kind kind = Kind::blobs;
  uint32_t node = 0;             ///< into FieldProgram::field.nodes
  uint32_t space = 0;            ///< into FieldProgram::spaces: where the blobs or the skeleton live
  uint32_t first = 0, count = 0; ///< of a skeleton `first` is its place in Identities::places
  Demand demand = Demand::value; ///< of an operator: what is asked of it in the whole tree
};

/// Steps in post-order (the last one is the field), with what they refer to.
struct Code {
  std::vector<Instruction> steps;
  std::vector<uint32_t> operands; ///< positions of steps
  std::vector<uint32_t> blobs;    ///< indices into FieldProgram::blobs
};

/// Where leaves live. A point of the space is warp(local_from_parent(point of the parent space)).
struct Space {
  static constexpr uint32_t k_no_warp = ~0u;
  uint32_t parent = 0; ///< into FieldProgram::spaces; 0, the world, is its own
  Affine local_from_parent{};
  uint32_t warp = k_no_warp; ///< the node of a warp that is not affine, if there is one

  bool is_affine_in_world() const { return parent == 0 && warp == k_no_warp; }
};

/// Whose a leaf of a program is.
struct LeafIdentity {
  uint32_t node = 0;  ///< of the sampled field, as the scene has it: a leaf, a cloud or a complex primitive. Instances share nodes
  uint32_t part = 0;  ///< which of a cloud's blobs or of a complex primitive's pieces; else 0
  uint32_t place = 0; ///< into Identities::places: what a blob is made of. Of others their instruction says it

  friend bool operator==(const LeafIdentity&, const LeafIdentity&) = default;
};

/// A source of blobs whose matter flows: it has the way of each blob, `BlobFlow flow_of(blob)`, a `progress` from 0 to 1, and may have
/// materials of its own at both ends.
template <class K>
concept FlowingSource = BlobSource<K> && requires(const K k) {
  { k.flow_of(0u) } -> std::same_as<BlobFlow>;
  k.progress, k.from_material, k.to_material;
};

/// What leaves are made of that lie below a node with a material, and where that material lives.
struct MaterialPlace {
  MaterialIndex material; ///< none: nothing above says
  uint32_t space = 0;     ///< into FieldProgram::spaces; of what flows that of its node
  bool flows = false;     ///< it is of blobs of a FlowingSource

  friend bool operator==(const MaterialPlace&, const MaterialPlace&) = default;
};

/// Whose all leaves are that are not nodes themselves, and what all are made of.
struct Identities {
  std::vector<LeafIdentity> blobs;   ///< of each blob of the program
  std::vector<LeafIdentity> pieces;  ///< of each node behind the root of the sampled field; the last, which is none, has any
  std::vector<MaterialPlace> places; ///< the first has no material
};

/// Finding the faces of hulls takes the fourth power of this.
inline constexpr size_t k_most_hull_points = 64;

struct Motion;

/// The compiled field of one shape. Leaves refer to `field`, so it is held here.
struct FieldProgram {
  double threshold = 1;
  SampledField field;
  BlobArrays blobs;
  BlobsBetween moving_blobs;                                 ///< of a program at a moment (motion.h), instead of its own
  std::vector<Space> spaces;                                 ///< parents before children; the first is the world
  Code code;                                                 ///< everything, not pruned
  std::unordered_map<uint32_t, std::vector<HullFace>> hulls; ///< of nodes that are polyhedra of few points, and stand
  Box3d support;                                             ///< the field is at most 0 outside
  std::shared_ptr<const Identities> identities;              ///< only if it was compiled with them
  std::shared_ptr<const Motion> motion;                      ///< how all this changes over a slab of time (motion.h); null: it does not

  BlobNumbers blob(uint32_t i) const;
  bool has_round_blobs() const { return (moving_blobs.start ? *moving_blobs.start : blobs).are_round(); }
  /// Number of blobs and skeletons.
  size_t element_count() const;
  /// Whose the skeleton of a node is.
  LeafIdentity identity_of(uint32_t node) const {
    return node <= field.root() ? LeafIdentity{node, 0} : identities->pieces[node - field.root() - 1];
  }
};

struct CompileOptions {
  bool with_identities = false; ///< 12 bytes a blob; cells then keep their programs, too
};

/// Compiles a sampled field: affine warps are folded into the leaves (into the blobs themselves where the
/// warp is a similarity), any other warp becomes a space, nested blends become one sum, and all blobs of a
/// sum in one space one step.
FieldProgram compile(SampledField field, double threshold, CompileOptions = {});

/// The same for several moments of one tree, with one threshold each: programs of the same structure, that is, with the
/// same code, the same spaces and as many blobs. What is done for one moment only if its numbers allow it is done if
/// those of all moments do.
std::vector<FieldProgram> compile(std::vector<SampledField> moments, std::span<const double> thresholds, CompileOptions = {});

} // namespace kelpie
