#include "bridge/can/transport/replay_can.h"

#include <poll.h>

#include <algorithm>
#include <sstream>

#include "bridge/can/bit_timing.h"
#include "components/base/config/config.h"

namespace sinew::can {

std::vector<LogLine> ReadCandumpFile(const std::string& path) {
  std::istringstream text(config::ReadFile(path, config::kLargestData));
  std::vector<LogLine> lines;
  std::string line;
  for (int number = 1; std::getline(text, line); ++number) {
    if (line.empty()) continue;
    const auto parsed = ParseCandump(line);
    if (!parsed && IsCanXl(line)) {
      throw UsageError(path + ":" + std::to_string(number) +
                       ": a frame of CAN XL, which is not read, expected classic CAN or CAN FD");
    }
    if (!parsed) {
      throw UsageError(
          path + ":" + std::to_string(number) +
          ": not a line of candump -l, expected '(1436509052.249713) can0 044#2A366C2BBA'");
    }
    lines.push_back(*parsed);
  }
  return lines;
}

ReplayCan::ReplayCan(std::string name, const std::vector<LogLine>& lines,
                     const std::string& interface, std::vector<IdFilter> filters)
    : name_(std::move(name)) {
  for (const LogLine& line : lines) {
    if ((interface.empty() || line.interface == interface) && Passes(filters, line.frame))
      lines_.push_back(line);
  }
  std::stable_sort(lines_.begin(), lines_.end(),
                   [](const LogLine& a, const LogLine& b) { return a.stamp_ns < b.stamp_ns; });
  if (!lines_.empty()) shift_ns_ = types::MonotonicNow_ns() - lines_.front().stamp_ns;
}

SendStatus ReplayCan::Send(const Frame&) noexcept {
  ++counters_.dropped;
  return SendStatus::kDown;
}

bool ReplayCan::Receive(std::chrono::nanoseconds timeout, Received* received) noexcept {
  if (next_ >= lines_.size()) {
    const timespec wait{static_cast<time_t>(timeout.count() / 1'000'000'000),
                        static_cast<long>(timeout.count() % 1'000'000'000)};
    ::ppoll(nullptr, 0, &wait, nullptr);
    return false;
  }
  const LogLine& line = lines_[next_];
  const std::int64_t due_ns = line.stamp_ns + shift_ns_;
  const std::int64_t wait_ns =
      std::min<std::int64_t>(due_ns - types::MonotonicNow_ns(), timeout.count());
  if (wait_ns > 0) {
    const timespec wait{static_cast<time_t>(wait_ns / 1'000'000'000),
                        static_cast<long>(wait_ns % 1'000'000'000)};
    ::ppoll(nullptr, 0, &wait, nullptr);
  }
  if (types::MonotonicNow_ns() < due_ns) return false;
  *received = {line.frame, due_ns};
  ++next_;
  if (line.frame.error) {
    ++counters_.error_frames;
  } else {
    ++counters_.received;
    counters_.wire_bits += static_cast<std::uint64_t>(FrameBits(line.frame));
  }
  return true;
}

}  // namespace sinew::can
