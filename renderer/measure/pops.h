// What jumps from one frame to the next.
#pragma once

#include <span>
#include <vector>

namespace kelpie {

/// A change is a pop if it is more than this many times the median of the k_pop_neighbours changes around it, and more than k_least_pop of
/// the whole: of the volume, the area, or a picture that turns from black to white.
inline constexpr double k_pop_factor = 3, k_least_pop = 0.002;
inline constexpr size_t k_pop_neighbours = 10;

/// The median of the k_pop_neighbours changes nearest to `at` in time, without its own, half of them before it where there are as many;
/// at the ends of a sequence more of one side. 0 where there is no other.
double usual_change(std::span<const double> changes, size_t at);

/// Which of the changes are pops. All are shares of the whole, none is negative.
std::vector<size_t> find_pops(std::span<const double> changes);

} // namespace kelpie
