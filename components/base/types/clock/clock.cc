#include "components/base/types/clock/clock.h"

#include <ctime>

namespace sinew::types {
namespace {

std::int64_t Read_ns(clockid_t clock) noexcept {
  timespec now{};
  ::clock_gettime(clock, &now);
  return static_cast<std::int64_t>(now.tv_sec) * 1'000'000'000 + now.tv_nsec;
}

}  // namespace

std::int64_t MonotonicNow_ns() noexcept { return Read_ns(CLOCK_MONOTONIC); }

std::int64_t EpochNow_ns() noexcept { return Read_ns(CLOCK_REALTIME); }

}  // namespace sinew::types
