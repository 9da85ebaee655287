// A cap on the memory that building a frame takes.
#pragma once

#include <atomic>
#include <cstddef>

namespace kelpie {

/// Counts bytes by what is built, not by what the system says: whether a frame fits is then the same on every machine
/// and for any number of threads.
class MemoryBudget {
public:
  struct Exceeded {};

  explicit MemoryBudget(size_t most) : most_(most) {}

  /// Throws Exceeded once all that was taken is more than there is.
  void take(size_t bytes) {
    if (taken_.fetch_add(bytes) + bytes > most_) throw Exceeded{};
  }

private:
  size_t most_;
  std::atomic<size_t> taken_{0};
};

} // namespace kelpie
