#include "cli/background_task.h"

#include <memory>
#include <system_error>
#include <utility>

namespace kelpie {

void BackgroundTask::start(std::function<void()> work) {
  wait();
  const auto run = [this, work = std::make_shared<std::function<void()>>(std::move(work))]() noexcept {
    try {
      (*work)();
    } catch (...) {
      failure_ = std::current_exception();
      has_failed_ = true;
    }
  };
  try {
    thread_ = std::jthread(run);
  } catch (const std::system_error&) {
    run();
  }
}

void BackgroundTask::wait() {
  if (thread_.joinable()) thread_.join();
  has_failed_ = false;
  if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
}

} // namespace kelpie
