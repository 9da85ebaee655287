// How much memory this process may take.
#pragma once

#include <cstddef>

namespace kelpie {

/// The least of what the machine has, what the control groups of this process permit, and what is left of its address space
/// (RLIMIT_AS), in bytes.
size_t memory_limit();

/// What work of which the size is known beforehand may take of that: 70 %, as the system and what cannot be counted need some.
inline size_t usable_memory() { return memory_limit() / 10 * 7; }

} // namespace kelpie
