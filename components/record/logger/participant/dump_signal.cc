#include "components/record/logger/participant/dump_signal.h"

#include <atomic>

namespace sinew::logger {

namespace {

std::atomic<bool> dump_requested{false};
static_assert(std::atomic<bool>::is_always_lock_free, "it is set in a signal handler");

void RequestDump(int) { dump_requested.store(true, std::memory_order_relaxed); }

}  // namespace

DumpSignal::DumpSignal() {
  struct sigaction action {};
  action.sa_handler = &RequestDump;
  action.sa_flags = SA_RESTART;
  sigemptyset(&action.sa_mask);
  ::sigaction(SIGUSR1, &action, &before_);
}

DumpSignal::~DumpSignal() { ::sigaction(SIGUSR1, &before_, nullptr); }

bool DumpSignal::Take() noexcept { return dump_requested.exchange(false); }

}  // namespace sinew::logger
