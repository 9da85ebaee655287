// A field, compiled for one frame: a flat program in post-order.
#pragma once

#include <cstdint>
#include <span>
#include <unordered_map>

#include "field/skeletons/hull_faces.h"
#include "scene/scene.h"

namespace kelpie {

/// The blobs of a program in structure-of-arrays form. The potential of one is q^2 (a + b q) with
/// q = max(0, 1 - |p - centre|^2 k): the weight is folded into the falloff's polynomial.
struct BlobArrays {
  std::vector<float> x, y, z, radius, k, a, b;

  size_t size() const { return x.size(); }
  void push(const Blob&);
};

/// One step of a program; its value is stored at its own position.
struct Instruction {
  enum class Kind : uint32_t {
    blobs,    ///< the sum of blobs  [first, first + count) of the blob list; 0 if count is 0
    skeleton, ///< the potential of the skeleton `node`
    combine,  ///< the operator `node` on the values of the steps [first, first + count) of the operand list
  };
  Kind kind = Kind::blobs;
  uint32_t node = 0;  ///< into FieldProgram::field.nodes
  uint32_t space = 0; ///< into FieldProgram::spaces: where the blobs or the skeleton live
  uint32_t first = 0, count = 0;
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

/// Finding the faces of hulls takes the fourth power of this.
inline constexpr size_t k_most_hull_points = 64;

struct Motion;

/// The compiled field of one shape. Leaves refer to `field`, so it is held here.
struct FieldProgram {
  double threshold = 1;
  SampledField field;
  BlobArrays blobs;
  std::vector<Space> spaces;                                 ///< parents before children; the first is the world
  Code code;                                                 ///< everything, not pruned
  std::unordered_map<uint32_t, std::vector<HullFace>> hulls; ///< of nodes that are polyhedra of few points, and stand
  Box3d support;                                             ///< the field is at most 0 outside
  std::shared_ptr<const Motion> motion;                      ///< how all this changes over a slab of time (motion.h); null: it does not

  /// Number of blobs and skeletons.
  size_t element_count() const;
};

/// Compiles a sampled field: affine warps are folded into the leaves (into the blobs themselves where the
/// warp is a similarity), any other warp becomes a space, nested blends become one sum, and all blobs of a
/// sum in one space one step.
FieldProgram compile(SampledField field, double threshold);

/// The same for several moments of one tree, with one threshold each: programs of the same structure, that is, with the
/// same code, the same spaces and as many blobs. What is done for one moment only if its numbers allow it is done if
/// those of all moments do.
std::vector<FieldProgram> compile(std::vector<SampledField> moments, std::span<const double> thresholds);

} // namespace kelpie
