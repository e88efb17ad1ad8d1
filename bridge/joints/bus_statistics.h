// Health of the buses as provider::BusReport: link and counters of now, those of the body nodes
// included, and of the last second the load, the answer times and the bridge's work per cycle.
//
//     load = bits on the wire in the second / (bit rate * span)
//
// Times are of the transport's clock and come in. One thread; allocates in the constructor only.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "bridge/can/transport/transport.h"
#include "components/robot/provider/plant.h"

namespace sinew::bridge {

// Time from a request to its answer. An answer without a request, or with a stamp before the
// request, does not count.
class RequestTimer {
 public:
  void Start(std::int64_t now_ns) { asked_ns_ = now_ns; }
  std::optional<double> Stop(std::int64_t stamp_ns);  // us

 private:
  std::int64_t asked_ns_ = 0;  // 0: no answer is awaited
};

// Median and largest of the newest 512 times since the last Summarize.
class RecentTimes {
 public:
  struct Summary {
    double median_us = 0.0;  // 0 where there were none
    double largest_us = 0.0;
  };
  void Add(double value_us) { values_us_[count_++ % values_us_.size()] = value_us; }
  Summary Summarize();  // and begins anew

 private:
  std::array<double, 512> values_us_{};
  std::size_t count_ = 0;
};

// Since the start.
struct BodyCounts {
  std::uint64_t samples_missed = 0;  // by the gaps in the sequence numbers
  std::uint64_t lost = 0;            // how often a node fell silent, or its sequence stood still
};

struct BusSample {
  can::Link link = can::Link::kDown;
  can::TransportCounters counters;
  BodyCounts body = {};  // of the body nodes on this bus together
};

class BusStatistics {
 public:
  explicit BusStatistics(const std::vector<double>& bitrate_bit_s);

  // The first second begins.
  void Start(std::int64_t now_ns) { second_ns_ = now_ns; }
  void AddAnswer(int bus, double time_us) { answers_[static_cast<std::size_t>(bus)].Add(time_us); }
  // At the end of a cycle; a sample per bus.
  void Update(std::span<const BusSample> buses, double work_us, std::int64_t now_ns);

  const provider::BusReport& report() const { return report_; }

 private:
  std::vector<double> bitrate_bit_s_;
  provider::BusReport report_;
  std::int64_t second_ns_ = 0;
  std::array<std::uint64_t, provider::BusReport::kMaxBuses> second_bits_{};
  RecentTimes work_;
  std::vector<RecentTimes> answers_;  // per bus
};

}  // namespace sinew::bridge
