// Loops on several threads.
#pragma once

#include <tbb/parallel_for.h>

#if defined(__SANITIZE_THREAD__)
#include <sanitizer/tsan_interface.h>
#define KELPIE_UNSEEN_BY_THREAD_SANITIZER __attribute__((no_sanitize_thread))
#else
#define KELPIE_UNSEEN_BY_THREAD_SANITIZER
#endif

namespace kelpie {

/// Tells the thread sanitizer what it cannot see, as neither TBB nor Embree is instrumented: what a thread did before give() is done
/// for every thread after take(). In any other build it is nothing.
class HandOver {
public:
#if defined(__SANITIZE_THREAD__)
  void give() { __tsan_release(this); }
  void take() { __tsan_acquire(this); }
#else
  void give() {}
  void take() {}
#endif
};

/// Calls body(i) for every i in [first, last), on the threads of the current TBB arena and in any order.
template <class Index, class Body>
void parallel_for(Index first, Index last, const Body& body) {
  HandOver fork, join;
  fork.give();
  tbb::parallel_for(first, last, [&](Index i) KELPIE_UNSEEN_BY_THREAD_SANITIZER { // TBB copies this from thread to thread
    fork.take();
    body(i);
    join.give();
  });
  join.take();
}

} // namespace kelpie
