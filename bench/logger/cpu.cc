// CPU time of sinew-logger beside a process that reads the same topics and does nothing.
#include <signal.h>

#include <chrono>
#include <cstdio>
#include <stdexcept>
#include <string>
#include <thread>

#include "bench/logger/measures.h"
#include "bench/logger/process_cpu.h"
#include "bench/logger/traffic.h"
#include "components/record/recording/file/file_io.h"
#include "components/record/recording/mcap_reader.h"
#include "components/topics/node/options.h"
#include "tools/launch/program.h"

namespace sinew::logger_bench {

namespace {

constexpr double kGoalRatio = 1.5;

void WaitForReaders(const Traffic& traffic, int count) {
  const auto give_up = std::chrono::steady_clock::now() + std::chrono::seconds(30);
  while (traffic.matched_readers() < count) {
    if (std::chrono::steady_clock::now() > give_up) {
      throw std::runtime_error("the readers were not found within 30 s");
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
}

recording::TextMap LossesOf(const std::filesystem::path& file, std::uint64_t* messages) {
  recording::FileSource source(file);
  const recording::McapReader reader(source);
  *messages = reader.statistics().message_count;
  recording::TextMap losses;
  for (const recording::McapMetadata& metadata : reader.ReadMetadata()) {
    if (metadata.name == "sinew.losses") losses = metadata.values;
  }
  return losses;
}

}  // namespace

void ReadInVain(int domain_id) {
  node::StopFlag stop;
  node::Options options;
  options.name = "reader";
  options.component = "record";  // a socket as large as the logger's
  options.domain_id = domain_id;
  node::Node node(options);
  for (const std::string& topic : RigTopics()) {
    node.ReadRaw(
        *node::FindTopic(topic), [](node::RawSample&&) {}, /*wakes=*/false);
  }
  while (!stop.requested()) node.WaitForData(std::chrono::milliseconds(50));
}

bool MeasureCpu(const CpuOptions& options) {
  const std::string domain = std::to_string(options.domain_id);
  const std::filesystem::path file = options.folder / "cpu.mcap";
  const std::string bin = SINEW_BIN_DIR;
  launch::Program logger({bin + "/sinew-logger", "--domain", domain, "--out", file.string(),
                          "--overwrite", "--topics", RigTopicList(), "--compression",
                          options.compression, "--keep-going"});
  launch::Program reader({bin + "/logger_bench", "reader", "--domain", domain});
  const Traffic traffic(options.domain_id, options.rate_Hz);
  WaitForReaders(traffic, 2);
  std::this_thread::sleep_for(std::chrono::seconds(1));  // past the start of both
  const double logger_before = CpuOf_s(logger.pid()), reader_before = CpuOf_s(reader.pid());
  const std::uint64_t ticks_before = traffic.ticks();
  std::this_thread::sleep_for(std::chrono::duration<double>(options.seconds));
  const double logger_s = CpuOf_s(logger.pid()) - logger_before;
  const double reader_s = CpuOf_s(reader.pid()) - reader_before;
  const double rate_Hz = static_cast<double>(traffic.ticks() - ticks_before) / options.seconds;
  logger.Signal(SIGINT);
  reader.Signal(SIGTERM);
  if (logger.Wait(std::chrono::seconds(30)) != 0) throw std::runtime_error(logger.error());
  reader.Wait(std::chrono::seconds(10));

  std::uint64_t messages = 0;
  recording::TextMap losses = LossesOf(file, &messages);
  const double ratio = logger_s / reader_s;
  std::printf("%zu topics at %.0f Hz (asked for: %.0f), compression %s, %.0f s\n",
              RigTopics().size(), rate_Hz, options.rate_Hz, options.compression.c_str(),
              options.seconds);
  std::printf("reader that does nothing  %6.1f %% of a core\n", 100.0 * reader_s / options.seconds);
  std::printf("sinew-logger              %6.1f %% of a core, %.2f times (goal: %.1f)\n",
              100.0 * logger_s / options.seconds, ratio, kGoalRatio);
  std::printf("%llu messages recorded; lost %s, missing %s, dropped %s\n",
              static_cast<unsigned long long>(messages), losses["all.lost"].c_str(),
              losses["all.missing"].c_str(), losses["all.dropped"].c_str());
  return ratio <= kGoalRatio && losses["all.missing"] == "0" && losses["all.lost"] == "0" &&
         losses["all.dropped"] == "0";
}

}  // namespace sinew::logger_bench
