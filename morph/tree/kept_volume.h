// How thick a skeleton must be on its way for the solid that it makes to keep its volume.
#pragma once

#include "morph/tree/skeleton_graph.h"

namespace kelpie {

/// By what to multiply the radius of influence at each `s` from 0 to 1 of a path of two stages, in the middle of which skeletons have
/// shrunk to what they have in common: so much that the solid's volume goes evenly from that of the one end to that of the other. 1 at
/// both ends. The solid is where a lone leaf has half its weight; volumes are counted on some thousand points, as things are at `frame`.
/// 1 everywhere for kinds that cannot be measured, and for paths of one stage.
Curve<float> factor_for_volume(const SkeletonPath&, double frame);

} // namespace kelpie
