#pragma once

#include <cstddef>

namespace kelpie {

/// The largest packet of rays, and the most lanes of a vector.
inline constexpr size_t k_packet = 16;

} // namespace kelpie
