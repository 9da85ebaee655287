#include "renderer/cpu_time.h"

#include <ctime>
#include <mutex>
#include <optional>

#include <pthread.h>

namespace kelpie {

namespace {

double seconds_of(clockid_t clock) {
  timespec t{};
  clock_gettime(clock, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

std::mutex g_mutex;
std::optional<clockid_t> g_aside_clock;
double g_aside_s = 0; // without what the clock has

} // namespace

double process_cpu_s() {
  const std::lock_guard lock(g_mutex);
  return seconds_of(CLOCK_PROCESS_CPUTIME_ID) - g_aside_s - (g_aside_clock ? seconds_of(*g_aside_clock) : 0);
}

double thread_cpu_s() { return seconds_of(CLOCK_THREAD_CPUTIME_ID); }

AsideThread::AsideThread() {
  clockid_t clock;
  if (pthread_getcpuclockid(pthread_self(), &clock) != 0) return;
  const std::lock_guard lock(g_mutex);
  g_aside_s -= seconds_of(clock);
  g_aside_clock = clock;
}

AsideThread::~AsideThread() {
  const std::lock_guard lock(g_mutex);
  if (g_aside_clock) g_aside_s += seconds_of(*g_aside_clock);
  g_aside_clock.reset();
}

} // namespace kelpie
