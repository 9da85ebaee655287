// Between two matched clouds of blobs.
#pragma once

#include <array>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "base/kind.h"
#include "base/spline.h"
#include "field/potential/blob.h"
#include "morph/liquid/blob_shape.h"
#include "morph/liquid/match.h"

namespace kelpie {

/// How blobs find their partners, and what becomes of them on the way.
enum class Correspondence {
  flow, ///< optimal transport of the potentials' mass through the bodies, where parts keep the liquid even (body_graph.h, local_balance.h)
  transport, ///< the same by straight ways, from centre of mass to centre of mass
  cellular,  ///< the paper's: nearest spheres are partners (eq. 5), and their parameters move linearly
};

template <>
struct EnumNames<Correspondence> {
  static constexpr std::array<std::pair<std::string_view, Correspondence>, 3> values{
      {{"flow", Correspondence::flow}, {"transport", Correspondence::transport}, {"cellular", Correspondence::cellular}}};
};

/// What becomes of the volume between the ends.
enum class VolumeRule { free, linear };

template <>
struct EnumNames<VolumeRule> {
  static constexpr std::array<std::pair<std::string_view, VolumeRule>, 2> values{
      {{"free", VolumeRule::free}, {"linear", VolumeRule::linear}}};
};

/// What the liquid is at its ends.
enum class LiquidEnds {
  exact,  ///< the two clouds
  molten, ///< as smooth as between: whatever hides the ends melts into it and sets from it (of Correspondence::flow only)
};

template <>
struct EnumNames<LiquidEnds> {
  static constexpr std::array<std::pair<std::string_view, LiquidEnds>, 2> values{
      {{"exact", LiquidEnds::exact}, {"molten", LiquidEnds::molten}}};
};

/// Two clouds, cut into parts that are paired one to one.
class LiquidMorph {
public:
  /// Neither cloud may be empty. Takes some tenths of a second for clouds of some hundred blobs with
  /// VolumeRule::linear; the result does not depend on the number of threads.
  LiquidMorph(const BlobCloud& from, const BlobCloud& to, Correspondence how, VolumeRule rule, LiquidEnds ends = LiquidEnds::exact)
      : LiquidMorph(from, to, how, rule, ends, ends) {}
  /// Of which only one end may be molten.
  LiquidMorph(const BlobCloud& from, const BlobCloud& to, Correspondence, VolumeRule, LiquidEnds at_from, LiquidEnds at_to);

  /// Appends the blobs at `progress` in [0, 1]: at 0 exactly `from`, at 1 exactly `to` (LiquidEnds::exact), and the field
  /// changes continuously in between. Centres move linearly. With Correspondence::cellular so do the radius e, the
  /// stiffness B and the weight w (blob_shape.h); with transport the radius R and the mass W R^3 do; with flow parts of ellipsoids are
  /// round on the way. Under VolumeRule::linear all weights bear a common factor by which the volume where the sum exceeds 1 changes
  /// linearly.
  void append_blobs(float progress, BlobCloud& out) const;
  /// The same field, but for rounding, cut into the same parts at every progress.
  void append_parts(float progress, BlobCloud& out) const { append_parts(progress, gain_at(progress), out); }
  size_t part_count() const { return parts_.size(); }
  /// Which blobs become one another as this part.
  const Link& link(size_t part) const { return parts_[part].link; }
  Falloff falloff_from(size_t part) const { return parts_[part].from.falloff; }
  Falloff falloff_to(size_t part) const { return parts_[part].to.falloff; }
  bool is_of_two_falloffs(size_t part) const { return falloff_from(part) != falloff_to(part); }
  /// Of which part each of the blobs is that append_parts appends.
  const std::vector<uint32_t>& part_of_blob() const { return part_of_blob_; }
  /// The factor of all weights that keeps the volume linear.
  float gain_at(float progress) const;

  /// A part is a blob, and another in the same place where it goes over into another falloff: that of its end.
  struct PartBlobs {
    Blob blob;
    std::optional<Blob> other;
  };
  /// At a progress of which gain_at is known.
  PartBlobs part_at(size_t part, float progress, float gain) const;
  const BlobCloud& from() const { return from_; }
  const BlobCloud& to() const { return to_; }

private:
  struct End {
    Vec3 centre{0};
    BlobShape shape;  ///< with its share of the weight
    float radius = 1; ///< R
    float mass = 1;   ///< its share of W R^3
    Falloff falloff = Falloff::quartic;
    SymmetricMat3 form{}; ///< the ellipsoid's, as Blob::shape
  };
  struct Part {
    End from, to;
    Link link;
    Spline<Vec3d> path;                      ///< of its centre
    std::optional<Spline<double>> balance{}; ///< the logarithm of its weight's own factor; none: 1
  };
  Blob interpolate(const Part&, float progress, float gain) const;
  void append_parts(float progress, float gain, BlobCloud& out) const;
  void add_parts(const std::vector<Link>&, const BodyGraph*);
  bool is_molten(LiquidEnds end) const { return how_ == Correspondence::flow && end == LiquidEnds::molten; }
  float away_from(float progress) const;
  float away_to(float progress) const;
  SymmetricMat3 form(const Part&, float progress) const;
  float flow_radius(const Part&, float progress) const;
  std::pair<int, int> free_steps(int steps) const;
  void spread_parts();
  void find_balance();
  void find_gains();

  BlobCloud from_, to_;
  Box3 box_;              ///< of the supports of both
  float drop_radius_ = 0; ///< the least radius of influence on the way
  Correspondence how_;
  LiquidEnds at_from_, at_to_;
  std::vector<Part> parts_;
  std::vector<uint32_t> part_of_blob_; ///< of what append_parts appends
  std::optional<Spline<double>> gain_; ///< the factor of all weights that keeps the volume linear; none: 1
};

} // namespace kelpie
