// A logger that is killed at any instant: what its file lacks.
#include <signal.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <random>
#include <stdexcept>
#include <thread>
#include <vector>

#include "bench/logger/measures.h"
#include "bench/logger/traffic.h"
#include "components/base/types/clock/clock.h"
#include "components/record/recording/file/file_io.h"
#include "components/record/recording/mcap_reader.h"
#include "tools/launch/program.h"

namespace sinew::logger_bench {

namespace {

constexpr double kGoal_ms = 200.0;

std::uint64_t MessagesIn(const std::filesystem::path& file) {
  try {
    recording::FileSource source(file);
    return recording::McapReader(source).statistics().message_count;
  } catch (const std::exception&) {  // not there yet
    return 0;
  }
}

// From the newest message in the file to the kill, ms.
double KillOne_ms(const KillOptions& options, double delay_s) {
  const std::filesystem::path file = options.folder / "killed.mcap";
  std::filesystem::remove(file);
  launch::Program logger({std::string(SINEW_BIN_DIR) + "/sinew-logger", "--domain",
                          std::to_string(options.domain_id), "--out", file.string(), "--topics",
                          RigTopicList(), "--keep-going"});
  const auto give_up = std::chrono::steady_clock::now() + std::chrono::seconds(30);
  while (MessagesIn(file) == 0) {
    if (std::chrono::steady_clock::now() > give_up) {
      throw std::runtime_error("nothing was recorded within 30 s: " + logger.error());
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  std::this_thread::sleep_for(std::chrono::duration<double>(delay_s));
  const std::int64_t killed_ns = types::EpochNow_ns();
  logger.Signal(SIGKILL);
  logger.Wait(std::chrono::seconds(10));
  recording::FileSource source(file);
  const recording::McapReader reader(source);  // throws for a file that cannot be opened
  return 1e-6 * static_cast<double>(killed_ns - reader.statistics().end_time_ns);
}

}  // namespace

bool MeasureKills(const KillOptions& options) {
  const Traffic traffic(options.domain_id, options.rate_Hz);
  std::mt19937 random(options.seed);
  std::uniform_real_distribution<double> delay_s(0.0, 0.5);  // five chunks
  std::vector<double> lost_ms;
  for (int i = 0; i < options.count; ++i) lost_ms.push_back(KillOne_ms(options, delay_s(random)));
  std::sort(lost_ms.begin(), lost_ms.end());
  const auto within =
      std::count_if(lost_ms.begin(), lost_ms.end(), [](double lost) { return lost <= kGoal_ms; });
  std::printf("%d kills, every file opens; lost at most %.0f ms: %lld of %d\n", options.count,
              kGoal_ms, static_cast<long long>(within), options.count);
  std::printf("median %.0f ms, worst %.0f ms\n", lost_ms[lost_ms.size() / 2], lost_ms.back());
  return within == options.count;
}

}  // namespace sinew::logger_bench
