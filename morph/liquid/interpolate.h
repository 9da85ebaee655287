// Between two matched clouds of blobs.
#pragma once

#include <array>
#include <string_view>
#include <utility>
#include <vector>

#include "base/kind.h"
#include "field/potential/blob.h"
#include "morph/liquid/blob_shape.h"

namespace kelpie {

/// How blobs find their partners, and what becomes of them on the way.
enum class Correspondence {
  transport, ///< optimal transport of the potentials' mass, which is kept on the way (match_transport.h)
  cellular,  ///< the paper's: nearest spheres are partners (eq. 5), and their parameters move linearly
};

template <>
struct EnumNames<Correspondence> {
  static constexpr std::array<std::pair<std::string_view, Correspondence>, 2> values{
      {{"transport", Correspondence::transport}, {"cellular", Correspondence::cellular}}};
};

/// What becomes of the volume between the ends.
enum class VolumeRule { free, linear };

template <>
struct EnumNames<VolumeRule> {
  static constexpr std::array<std::pair<std::string_view, VolumeRule>, 2> values{
      {{"free", VolumeRule::free}, {"linear", VolumeRule::linear}}};
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
  LiquidMorph(const BlobCloud& from, const BlobCloud& to, Correspondence, VolumeRule);

  /// Appends the blobs at `progress` in [0, 1]: at 0 exactly `from`, at 1 exactly `to`, and the field
  /// changes continuously in between. Centres move linearly. With Correspondence::cellular so do the radius e, the
  /// stiffness B and the weight w (blob_shape.h); with transport the radius R and the mass W R^3 do. Under VolumeRule::linear all weights
  /// bear a common factor by which the volume where the sum exceeds 1 changes linearly.
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
  };
  struct Part {
    End from, to;
  };
  static bool is_of_two_falloffs(const Part& p) { return p.from.falloff != p.to.falloff; }
  Blob interpolate(const Part&, float progress, float gain) const;
  void append_parts(float progress, float gain, BlobCloud& out) const;
  void find_gains();
  float gain_at(float progress) const;

  BlobCloud from_, to_;
  Correspondence how_;
  std::vector<Part> parts_;
  std::vector<uint32_t> part_of_blob_; ///< of what append_parts appends
  std::vector<float> gain_;            ///< the factor of all weights that keeps the volume linear, at equal steps of progress
};

} // namespace kelpie
