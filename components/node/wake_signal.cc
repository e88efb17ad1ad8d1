#include "components/node/wake_signal.h"

namespace sinew::node::internal {

void WakeSignal::Notify(const void* source) {
  bool wake = false;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    raised_ = true;
    wake = waiting_ && (awaited_ == nullptr || awaited_ == source);
  }
  if (wake) condition_.notify_one();
}

bool WakeSignal::Wait(std::chrono::microseconds timeout, const void* source) {
  std::unique_lock<std::mutex> lock(mutex_);
  awaited_ = source;
  waiting_ = true;
  const bool raised = condition_.wait_for(lock, timeout, [this] { return raised_; });
  waiting_ = false;
  raised_ = false;
  return raised;
}

}  // namespace sinew::node::internal
