#include "components/topics/node/wake_signal.h"

#include <algorithm>

namespace sinew::node::internal {

namespace {

bool Holds(std::span<const void* const> sources, const void* source) {
  return std::find(sources.begin(), sources.end(), source) != sources.end();
}

}  // namespace

bool WakeSignal::Complete() const {
  if (awaited_.empty()) return !raised_.empty();
  if (Holds(raised_, nullptr)) return true;
  return std::all_of(awaited_.begin(), awaited_.end(),
                     [this](const void* source) { return Holds(raised_, source); });
}

void WakeSignal::Notify(const void* source) {
  bool wake = false;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (!Holds(raised_, source)) raised_.push_back(source);
    wake = waiting_ && Complete();
  }
  if (wake) condition_.notify_one();
}

bool WakeSignal::Wait(std::chrono::microseconds timeout, std::span<const void* const> sources) {
  std::unique_lock<std::mutex> lock(mutex_);
  awaited_ = sources;
  waiting_ = true;
  const bool complete = condition_.wait_for(lock, timeout, [this] { return Complete(); });
  waiting_ = false;
  awaited_ = {};
  raised_.clear();
  return complete;
}

}  // namespace sinew::node::internal
