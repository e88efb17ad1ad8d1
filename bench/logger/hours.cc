// Memory of a recorder over hours of data, written in process as fast as it goes.
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <fstream>
#include <memory>
#include <vector>

#include "bench/logger/measures.h"
#include "bench/logger/traffic.h"
#include "components/record/logger/recorder.h"

namespace sinew::logger_bench {

namespace {

constexpr double kGoalGrowth_MB = 4.0;  // what an allocator keeps may vary by
const std::vector<std::string> kTopics = {"joint_state", "actuator_state", "reference", "regime"};

class CountingSeries final : public logger::RecordingSink {
 public:
  recording::IoStatus Begin(int) override { return recording::IoStatus::Ok(); }
  recording::IoStatus Write(std::span<const std::byte>) override {
    return recording::IoStatus::Ok();
  }
  recording::IoStatus Sync() override { return recording::IoStatus::Ok(); }
  recording::IoStatus End() override { return recording::IoStatus::Ok(); }
};

double Resident_MB() {
  std::ifstream in("/proc/self/statm");
  long size = 0, resident = 0;
  in >> size >> resident;
  return static_cast<double>(resident) * static_cast<double>(::sysconf(_SC_PAGESIZE)) / 1e6;
}

}  // namespace

bool MeasureHours(const HourOptions& options) {
  std::vector<std::unique_ptr<ZeroMessage>> messages;
  std::vector<recording::TopicSchema> schemas;
  for (const std::string& name : kTopics) {
    const node::TopicInfo& topic = *node::FindTopic(name);
    messages.push_back(std::make_unique<ZeroMessage>(topic));
    schemas.push_back({topic.name, topic.type_name, topic.idl, topic.idl_hash});
  }
  logger::RecorderOptions recorder_options;
  recorder_options.wait_for_capacity = true;
  recorder_options.queue_bytes = 1u << 20;
  recorder_options.files.split_span = std::chrono::duration_cast<std::chrono::nanoseconds>(
      std::chrono::duration<double>(3600.0 * options.split_hours));
  CountingSeries sink;
  logger::Recorder recorder(sink, schemas, {}, recorder_options);

  const auto period_ns = static_cast<std::int64_t>(1e9 / options.rate_Hz);
  const auto ticks = static_cast<std::uint64_t>(3600.0 * options.rate_Hz * options.hours);
  const auto ticks_an_hour = static_cast<std::uint64_t>(3600.0 * options.rate_Hz);
  const auto start = std::chrono::steady_clock::now();
  double first_MB = 0.0, last_MB = 0.0;
  std::printf("%6s %12s %10s %6s\n", "hour", "messages", "MB", "files");
  for (std::uint64_t tick = 0; tick < ticks; ++tick) {
    const auto now_ns = static_cast<std::int64_t>(tick) * period_ns;
    for (std::size_t i = 0; i < messages.size(); ++i) {
      (void)recorder.Offer(i, messages[i]->At(tick, now_ns), now_ns);
    }
    if ((tick + 1) % ticks_an_hour != 0) continue;
    last_MB = Resident_MB();
    // While the first file's index is made whole at its end, it is in memory twice.
    if (tick + 1 <= 2 * ticks_an_hour) first_MB = last_MB;
    const logger::RecorderState state = recorder.state();
    std::printf("%6.0f %12llu %10.1f %6d\n",
                static_cast<double>(tick + 1) / static_cast<double>(ticks_an_hour),
                static_cast<unsigned long long>(state.messages), last_MB, state.files);
    std::fflush(stdout);
  }
  if (const recording::IoStatus status = recorder.Finish(); !status.ok()) {
    throw std::runtime_error(status.message());
  }
  const double took_s =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  std::printf("grown by %.1f MB since the second hour (goal: %.1f), in %.0f s\n",
              last_MB - first_MB, kGoalGrowth_MB, took_s);
  return last_MB - first_MB <= kGoalGrowth_MB;
}

}  // namespace sinew::logger_bench
