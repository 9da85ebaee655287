// Work that goes on beside other work.
#pragma once

#include <atomic>
#include <exception>
#include <functional>
#include <thread>

namespace kelpie {

/// One piece of work at a time, in a thread of its own. To be called by one thread; the destructor waits.
class BackgroundTask {
public:
  /// Waits for what was started before. Where there is no memory for a thread, the work is done here.
  void start(std::function<void()> work);
  /// Until what was started is done. Throws what it threw, once.
  void wait();
  /// Whether wait() will throw. By any thread.
  bool has_failed() const { return has_failed_; }

private:
  std::exception_ptr failure_;
  std::atomic<bool> has_failed_{false};
  std::jthread thread_; // last: it is joined before the rest goes
};

} // namespace kelpie
