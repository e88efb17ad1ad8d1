// The clocks of the machine. Any thread; they allocate nothing.
#pragma once

#include <cstdint>

namespace sinew::types {

// CLOCK_MONOTONIC: never set back, starts at an arbitrary instant. For waiting and durations.
std::int64_t MonotonicNow_ns() noexcept;

// CLOCK_REALTIME: since 1970-01-01 00:00:00 UTC. For stamps; may jump when the clock is set.
std::int64_t EpochNow_ns() noexcept;

}  // namespace sinew::types
