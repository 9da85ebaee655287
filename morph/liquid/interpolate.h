// Between two matched clouds of blobs.
#pragma once

#include <array>
#include <string_view>
#include <utility>
#include <vector>

#include "base/kind.h"
#include "field/blob.h"

namespace kelpie {

/// How blobs find their partners (methods.md section 1, step 3).
enum class Correspondence { cellular };

template <>
struct EnumNames<Correspondence> {
  static constexpr std::array<std::pair<std::string_view, Correspondence>, 1> values{{{"cellular", Correspondence::cellular}}};
};

/// What becomes of the volume between the ends.
enum class VolumeRule { free, linear };

template <>
struct EnumNames<VolumeRule> {
  static constexpr std::array<std::pair<std::string_view, VolumeRule>, 2> values{{{"free", VolumeRule::free}, {"linear", VolumeRule::linear}}};
};

/// Two clouds, cut into parts that are paired one to one.
class LiquidMorph {
public:
  LiquidMorph(const BlobCloud& from, const BlobCloud& to, Correspondence, VolumeRule);

  /// Appends the blobs at `progress` in [0, 1]; at 0 and 1 their sum is exactly that of `from` and `to`.
  void append_blobs(float progress, BlobCloud& out) const;

private:
  struct Part {
    Blob from, to;
  };
  std::vector<Part> parts_;
  std::vector<float> gain_; ///< the factor of all weights that keeps the volume linear, at equal steps of progress
};

} // namespace kelpie
