// A log played back as if it came from a bus: what others recorded with candump -l, or
// sinew-can-bus --log. Frames come at the distances they were recorded with; what is sent goes
// nowhere (and is counted). One thread.
#pragma once

#include <cstddef>

#include "bridge/can/candump.h"
#include "bridge/can/transport/transport.h"
#include "components/base/types/clock/clock.h"

namespace sinew::can {

// Reads a candump log. Throws UsageError naming file and line of the first line that is none.
std::vector<LogLine> ReadCandumpFile(const std::string& path);

class ReplayCan : public Transport {
 public:
  // `interface`: only its lines; empty: all.
  ReplayCan(std::string name, const std::vector<LogLine>& lines, const std::string& interface = {},
            std::vector<IdFilter> filters = {});

  SendStatus Send(const Frame& frame) noexcept override;
  bool Receive(std::chrono::nanoseconds timeout, Received* received) noexcept override;
  Link link() const noexcept override { return next_ < lines_.size() ? Link::kUp : Link::kDown; }
  TransportCounters counters() const noexcept override { return counters_; }
  std::int64_t now_ns() const noexcept override { return types::MonotonicNow_ns(); }
  const std::string& name() const noexcept override { return name_; }

 private:
  std::string name_;
  std::vector<LogLine> lines_;
  std::size_t next_ = 0;
  std::int64_t shift_ns_ = 0;  // from the log's stamps to ours
  TransportCounters counters_;
};

}  // namespace sinew::can
