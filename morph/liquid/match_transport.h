// Partners by optimal transport: the liquid takes the shortest way.
#pragma once

#include <vector>

#include "morph/liquid/match.h"

namespace kelpie {

/// A blob's mass is |W| R^3 (in proportion to the integral of its potential), its place that in the canonical frame
/// (centre of mass in the origin, mean square distance 1). The plan P moves the mass of `from`, made equal in sum,
/// to that of `to` at the least sum of mass times squared way, blurred by entropy (Sinkhorn's
/// iteration; Cuturi 2013); a blob is then split in proportion to what goes to each partner, parts of
/// a few percent left out. Neighbours travel together, so that what is whole stays whole. methods.md section 1, step 4.
std::vector<Link> match_transport(const BlobCloud& from, const BlobCloud& to);

} // namespace kelpie
