// Clouds of blobs in a row, each of which becomes the next one.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "morph/liquid/interpolate.h"

namespace kelpie {

/// Where the matter of a blob was at the beginning and will be at the end.
struct BlobFlow {
  Vec3 from{0}, to{0}; ///< centres
};

/// The ends are at equal parts of its progress. At the inner ones, which are exact, everything is matched anew, so that parts before and
/// after have nothing in common but their blobs.
class LiquidChain {
public:
  /// At least two clouds, none of them empty. `ends`: what the first and the last one are.
  LiquidChain(std::span<const BlobCloud* const> clouds, Correspondence, VolumeRule, LiquidEnds ends = LiquidEnds::exact);
  LiquidChain(const BlobCloud& from, const BlobCloud& to, Correspondence how, VolumeRule rule, LiquidEnds ends = LiquidEnds::exact)
      : LiquidChain(std::array{&from, &to}, how, rule, ends) {}

  // Both appenders number the blobs that they append upwards, and return the number of the first. A number is that of one thing, whoever
  // appends it, and flow_of knows it.

  /// The blobs at `progress` in [0, 1]: exactly those of a cloud where that says so, and in between as those of a LiquidMorph.
  uint32_t append_blobs(float progress, BlobCloud& out) const;
  /// The blobs at several moments, one cloud each, cut into the same parts at all of them: the fields are those of append_blobs but for
  /// rounding. Where moments lie on both sides of an inner end, a part is what goes from one blob through another to a third. Moments with
  /// several ends between them have all parts there are in common, of which those that are not there have no weight.
  uint32_t append_parts(std::span<const float> progress, std::span<BlobCloud> out) const;
  /// Of a blob that was appended, but at progress 0 and 1. Through an inner end matter goes as the mean of what flows into a blob, and out.
  BlobFlow flow_of(uint32_t blob) const { return flows_[blob]; }

  const std::vector<LiquidMorph>& passages() const { return passages_; }
  /// Of all passages together.
  size_t part_count() const;

private:
  /// The parts that a blob of an inner end comes from and goes to: one of the passage before, one of that after.
  struct Crossing {
    uint32_t before, after;
  };
  /// A place on the way: a passage, and how far it has gone.
  struct Place {
    size_t passage;
    float progress;
  };
  Place place_at(double way) const;
  double way_at(float progress) const;
  void add_crossings();
  void number_all();
  void append_crossings(size_t end, const Place&, BlobCloud& out) const;

  std::vector<LiquidMorph> passages_;
  std::vector<std::vector<Crossing>> crossings_; ///< of each inner end
  std::vector<BlobFlow> flows_;                  ///< by number
  // The numbers of the first blob of each passage, each inner end's crossings, and each inner end's cloud.
  std::vector<uint32_t> first_of_passage_, first_of_crossings_, first_of_cloud_;
};

} // namespace kelpie
