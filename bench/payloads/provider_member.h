// A state provider's input path: its readers, the cycle's decisions and the surrogate behind them.
// What run_provider.cc adds is timer and publishing, which read nothing from the wire.
#pragma once

#include <memory>

#include "bench/payloads/group.h"

namespace sinew::payloads {

std::unique_ptr<node::Component> MakeProvider(const node::Options& options,
                                              Environment& environment);

// The recorder with all topics; what it writes is counted and dropped.
std::unique_ptr<node::Component> MakeLogger(const node::Options& options, Environment& environment);

}  // namespace sinew::payloads
