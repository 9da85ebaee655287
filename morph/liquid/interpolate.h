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

/// Where the matter of a blob was at the beginning and will be at the end.
struct BlobFlow {
  Vec3 from{0}, to{0}; ///< centres
};

/// Two clouds, cut into parts that are paired one to one.
class LiquidMorph {
public:
  /// Neither cloud may be empty. Takes some tenths of a second for clouds of some hundred blobs with
  /// VolumeRule::linear; the result does not depend on the number of threads.
  LiquidMorph(const BlobCloud& from, const BlobCloud& to, Correspondence, VolumeRule, LiquidEnds = LiquidEnds::exact);

  /// Appends the blobs at `progress` in [0, 1]: at 0 exactly `from`, at 1 exactly `to` (LiquidEnds::exact), and the field
  /// changes continuously in between. Centres move linearly. With Correspondence::cellular so do the radius e, the
  /// stiffness B and the weight w (blob_shape.h); with transport the radius R and the mass W R^3 do; with flow parts of ellipsoids are
  /// round on the way. Under VolumeRule::linear all weights bear a common factor by which the volume where the sum exceeds 1 changes
  /// linearly.
  void append_blobs(float progress, BlobCloud& out) const;
  /// The same field, but for rounding, cut into the same parts at every progress.
  void append_parts(float progress, BlobCloud& out) const { append_parts(progress, gain_at(progress), out); }
  size_t part_count() const { return parts_.size(); }
  /// The way of one of the blobs that append_parts appends (append_blobs too, but at the ends).
  BlobFlow flow_of(uint32_t blob) const {
    const Part& part = parts_[part_of_blob_[blob]];
    return {part.from.centre, part.to.centre};
  }

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
    float from_share = 1, to_share = 1;      ///< of its blobs
    Spline<Vec3d> path;                      ///< of its centre
    std::optional<Spline<double>> balance{}; ///< the logarithm of its weight's own factor; none: 1
  };
  static bool is_of_two_falloffs(const Part& p) { return p.from.falloff != p.to.falloff; }
  Blob interpolate(const Part&, float progress, float gain) const;
  void append_parts(float progress, float gain, BlobCloud& out) const;
  void add_parts(const std::vector<Link>&, const BodyGraph*);
  bool is_molten() const { return how_ == Correspondence::flow && ends_ == LiquidEnds::molten; }
  float away_from_end(float progress) const;
  SymmetricMat3 form(const Part&, float progress) const;
  float flow_radius(const Part&, float progress) const;
  void spread_parts();
  void find_balance();
  void find_gains();
  float gain_at(float progress) const;

  BlobCloud from_, to_;
  Box3 box_;              ///< of the supports of both
  float drop_radius_ = 0; ///< the least radius of influence on the way
  Correspondence how_;
  LiquidEnds ends_;
  std::vector<Part> parts_;
  std::vector<uint32_t> part_of_blob_; ///< of what append_parts appends
  std::optional<Spline<double>> gain_; ///< the factor of all weights that keeps the volume linear; none: 1
};

} // namespace kelpie
