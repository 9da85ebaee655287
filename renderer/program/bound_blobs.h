// Bounds of a sum of blobs over a box: where building cells spends its time.
#pragma once

#include <cstdint>
#include <span>

#include "base/interval.h"
#include "renderer/program/program.h"

namespace kelpie {

/// Bounds the sum of the blobs in `list` over the box centre ± half, from the nearest and the farthest point of
/// the box to each centre, and from the value and slope at the box's centre. Those that reach the box go to
/// `kept`, in order; returns the number of them in `count`. `kept` has room for k_blob_bound_slack more than
/// the list. In float, like the tracer's arithmetic; the cells' tests of emptiness keep a margin for it.
Interval bound_blob_sum(const BlobArrays&, std::span<const uint32_t> list, const Vec3& centre, const Vec3& half, uint32_t* kept,
                        size_t& count);

/// The same where the blobs move: every number of each is anything between those of both arrays, and centres are
/// anywhere on the segment between. Unless they `change` only the centres differ.
Interval bound_moving_blob_sum(const BlobArrays& start, const BlobArrays& end, bool change, std::span<const uint32_t> list,
                               const Vec3& centre, const Vec3& half, uint32_t* kept, size_t& count);

inline constexpr size_t k_blob_bound_slack = 16;

} // namespace kelpie
