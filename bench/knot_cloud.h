// A cloud of overlapping blobs along a knotted tube, with stray drops: the scene of the benchmarks.
#pragma once

#include "field/potential/blob.h"

namespace kelpie {

/// About 20 blobs overlap at a point of the tube, however many there are: radii shrink as the count grows.
/// The same cloud on every machine.
BlobCloud make_knot_cloud(int count);

/// How many supports hold a centre, on average over a sample of the blobs.
double mean_overlap(const BlobCloud&);

} // namespace kelpie
