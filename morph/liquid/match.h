// Which blob of one cloud becomes which blob of another.
#pragma once

#include <vector>

#include "field/potential/blob.h"
#include "morph/liquid/interpolate.h"

namespace kelpie {

/// A pair of partners. A blob is split among its partners: this pair starts as `from_share` of the
/// weight of blob `from` and ends as `to_share` of that of blob `to`. The shares of a blob sum to 1.
struct Link {
  unsigned from = 0, to = 0;
  float from_share = 1, to_share = 1;
};

/// Every blob of either cloud (neither may be empty) has at least one partner. Clouds are compared in
/// a canonical frame, centred and scaled to a common size, so neither place nor size matters.
std::vector<Link> match_blobs(const BlobCloud& from, const BlobCloud& to, Correspondence);

} // namespace kelpie
