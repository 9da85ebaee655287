// The connected parts of what a field encloses, and what becomes of them from frame to frame.
#pragma once

#include <string>

#include "renderer/measure/isosurface.h"

namespace kelpie {

/// A connected part of the inside.
struct Part {
  double volume = 0, area = 0; ///< scene units, cubic and square; the area of its cavities too
  Vec3d centre{0};             ///< of its volume
  int genus = 0;               ///< handles, of all its surfaces together
  int cavities = 0;            ///< surfaces within
};

/// What of the inside is connected along the edges of the tetrahedra of a lattice.
struct Parts {
  static constexpr uint32_t k_outside = ~0u;

  std::vector<Part> parts;       ///< the largest first
  std::vector<uint32_t> of_node; ///< of each node of the lattice its part, or k_outside

  double volume() const;
  double area() const;
};

/// Volumes by the divergence theorem, genus by Euler's characteristic, V - E + F = 2 - 2 genus, of each closed surface.
Parts find_parts(const Isosurface&, const Lattice&);

/// A part comes or goes between two frames.
struct PartEvent {
  enum class Kind {
    appears,  ///< where there was nothing
    parts,    ///< from another, of which it was a piece
    vanishes, ///< into nothing
    merges,   ///< with another that is larger
  };
  Kind kind = Kind::appears;
  Vec3d place{0}; ///< its centre in the frame in which it is by itself
  double volume = 0;
  size_t part = 0; ///< in that frame
};

/// How the parts of two neighbouring frames belong together. Parts that overlap do; what moves farther than its own size is found again
/// where something of about its volume is near.
struct PartLinks {
  static constexpr size_t k_none = ~size_t(0);

  std::vector<size_t> earlier_of; ///< of each later part the earlier one that it is; k_none: it is new
  std::vector<PartEvent> events;
  /// The volume of all that came together or apart in each later part, before and after; the sum over all parts that overlap, also by
  /// way of others.
  struct Group {
    double before = 0, after = 0;
  };
  std::vector<Group> groups;    ///< those of later parts first, then those of which nothing is left
  std::vector<size_t> group_of; ///< of each later part
};

PartLinks link_parts(const Parts& earlier, const Parts& later);

} // namespace kelpie
