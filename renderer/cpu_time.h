// CPU seconds, as the statistics have them.
#pragma once

namespace kelpie {

/// CPU seconds of all threads of this process so far, but for what threads do aside.
double process_cpu_s();

/// CPU seconds of this thread so far.
double thread_cpu_s();

/// While it lives, what this thread does is aside: the writing of one frame while the next is rendered. One thread at a time.
class AsideThread {
public:
  AsideThread();
  ~AsideThread();
  AsideThread(const AsideThread&) = delete;
  AsideThread& operator=(const AsideThread&) = delete;
};

} // namespace kelpie
