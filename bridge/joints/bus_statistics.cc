#include "bridge/joints/bus_statistics.h"

#include <algorithm>

namespace sinew::bridge {
namespace {

constexpr std::int64_t kSecond_ns = 1'000'000'000;

}  // namespace

std::optional<double> RequestTimer::Stop(std::int64_t stamp_ns) {
  if (asked_ns_ == 0 || stamp_ns < asked_ns_) return std::nullopt;
  const double time_us = 1e-3 * static_cast<double>(stamp_ns - asked_ns_);
  asked_ns_ = 0;
  return time_us;
}

RecentTimes::Summary RecentTimes::Summarize() {
  const auto end = static_cast<std::ptrdiff_t>(std::min(count_, values_us_.size()));
  count_ = 0;
  if (end == 0) return {};
  const auto begin = values_us_.begin();  // their order is not needed any more
  std::nth_element(begin, begin + end / 2, begin + end);
  return {*(begin + end / 2), *std::max_element(begin, begin + end)};
}

BusStatistics::BusStatistics(const std::vector<double>& bitrate_bit_s)
    : bitrate_bit_s_(bitrate_bit_s), answers_(bitrate_bit_s.size()) {
  report_.bus_count = static_cast<int>(bitrate_bit_s.size());
}

void BusStatistics::Update(std::span<const BusSample> buses, double work_us, std::int64_t now_ns) {
  work_.Add(work_us);
  for (std::size_t b = 0; b < buses.size(); ++b) {
    const can::TransportCounters& counters = buses[b].counters;
    report_.up[b] = buses[b].link == can::Link::kUp || buses[b].link == can::Link::kPassive;
    report_.frames_sent[b] = counters.sent;
    report_.frames_received[b] = counters.received;
    report_.frames_dropped[b] = counters.dropped;
    report_.frames_lost[b] = counters.lost;
    report_.error_frames[b] = counters.error_frames;
    report_.body_samples_missed[b] = buses[b].body.samples_missed;
    report_.body_nodes_lost[b] = buses[b].body.lost;
  }
  const std::int64_t span_ns = now_ns - second_ns_;
  if (span_ns < kSecond_ns) return;
  second_ns_ = now_ns;
  for (std::size_t b = 0; b < buses.size(); ++b) {
    const std::uint64_t bits = buses[b].counters.wire_bits;
    report_.load_percent[b] = 100.0 * static_cast<double>(bits - second_bits_[b]) /
                              (bitrate_bit_s_[b] * 1e-9 * static_cast<double>(span_ns));
    second_bits_[b] = bits;
    const RecentTimes::Summary answers = answers_[b].Summarize();
    report_.answer_p50_us[b] = answers.median_us;
    report_.answer_max_us[b] = answers.largest_us;
  }
  const RecentTimes::Summary work = work_.Summarize();
  report_.cycle_p50_us = work.median_us;
  report_.cycle_max_us = work.largest_us;
}

}  // namespace sinew::bridge
