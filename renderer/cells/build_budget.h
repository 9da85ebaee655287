// A cap on the memory and the time that building a frame takes.
#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>

namespace kelpie {

/// Counts bytes by what is built, not by what the system says: whether a frame fits into an explicit cap is then the same on every
/// machine and for any number of threads. Knows which shape took how much.
class BuildBudget {
public:
  using Clock = std::chrono::steady_clock;
  struct Share {
    size_t shape = 0, bytes = 0;
  };
  /// What is thrown tells the shape that took most so far.
  struct OutOfMemory {
    Share costliest;
  };
  struct OutOfTime {
    Share costliest;
  };

  explicit BuildBudget(size_t most_bytes, Clock::time_point deadline = Clock::time_point::max()) : most_(most_bytes), deadline_(deadline) {}

  /// What is taken from now on is that shape's. Not while something is built.
  void enter(size_t shape) {
    costliest_ = costliest();
    shape_ = shape, before_ = taken_;
  }
  /// Throws OutOfMemory once all that was taken is more than there is.
  void take(size_t bytes) {
    if (taken_.fetch_add(bytes) + bytes > most_) throw OutOfMemory{costliest()};
  }
  /// Throws OutOfTime behind the deadline.
  void check_time() const {
    if (deadline_ != Clock::time_point::max() && Clock::now() > deadline_) throw OutOfTime{costliest()};
  }
  /// The shape that took most so far.
  Share costliest() const {
    const Share current{shape_, taken_ - before_};
    return current.bytes > costliest_.bytes ? current : costliest_;
  }

private:
  size_t most_;
  Clock::time_point deadline_;
  std::atomic<size_t> taken_{0};
  size_t shape_ = 0, before_ = 0; ///< the shape that is built, and what was taken before it
  Share costliest_;               ///< of those before it
};

} // namespace kelpie
