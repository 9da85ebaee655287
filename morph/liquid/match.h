// Which blob of one cloud becomes which blob of another.
#pragma once

#include <vector>

#include "field/potential/blob.h"

namespace kelpie {

class BodyGraph;

/// A pair of partners. A blob is split among its partners: this pair starts as `from_share` of the
/// weight of blob `from` and ends as `to_share` of that of blob `to`. The shares of a blob sum to 1.
struct Link {
  unsigned from = 0, to = 0;
  float from_share = 1, to_share = 1;
};

// Neither cloud may be empty; every blob of either has at least one partner.

/// Every sphere is linked with its nearest of the other cloud (methods.md section 1, eq. 5), in a canonical frame: clouds are centred and
/// scaled to a common size, so neither place nor size matters. A blob of weight w and k partners splits into k of weight w/k.
std::vector<Link> match_cellular(const BlobCloud& from, const BlobCloud& to);

/// By optimal transport. A blob's mass is |W| R^3, in proportion to the integral of its potential. The plan P moves the mass of `from`,
/// made equal in sum, to that of `to` at the least sum of mass times squared way, blurred by entropy (Sinkhorn's iteration; Cuturi 2013); a
/// blob is then split in proportion to what goes to each partner, parts of a few percent left out. Neighbours travel together, so that
/// what is whole stays whole. methods.md section 1, step 4.
///
/// Ways are straight, between places in the canonical frame (centre of mass in the origin, mean square distance 1).
std::vector<Link> match_transport(const BlobCloud& from, const BlobCloud& to);

/// The same, where ways lead through the bodies.
std::vector<Link> match_transport(const BlobCloud& from, const BlobCloud& to, const BodyGraph&);

} // namespace kelpie
