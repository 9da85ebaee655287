// Weights that keep the liquid even while its parts pass one another.
#pragma once

#include <span>
#include <vector>

#include "field/potential/blob.h"

namespace kelpie {

/// The sum of a cloud's potentials at the centre of each of its blobs.
std::vector<double> potentials_at_centres(const BlobCloud&);

/// How much larger a weight may become: enough for a thin neck to hold together, and too little for a crumb to become a drop.
inline constexpr double k_most_given = 1.5;

/// Parts that meet on their way pile up, and those that part leave a neck between them. These are the factors of the blobs' weights, no
/// more than k_most_given, by which the sum at each blob's centre becomes `wanted`, about: an iteration of few steps.
std::vector<double> balancing_factors(const BlobCloud&, std::span<const double> wanted);

} // namespace kelpie
