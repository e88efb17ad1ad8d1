// sinew-can-bus: a CAN bus between processes of one machine.
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>

#include "bridge/can/candump.h"
#include "bridge/can/transport/bus_server.h"
#include "bridge/can/transport/transport.h"
#include "components/base/types/clock/clock.h"
#include "components/topics/node/options.h"
#include "components/topics/node/realtime.h"

namespace {

using namespace sinew;

struct BusOptions {
  std::string bus = "can";
  std::string log_path;
  can::BusConfig config;
};

// candump -l writes epoch time; the bus stamps in monotonic time.
std::int64_t EpochShift_ns() { return types::EpochNow_ns() - types::MonotonicNow_ns(); }

struct CloseFile {
  void operator()(std::FILE* file) const { std::fclose(file); }
};

void Run(const BusOptions& options, node::StopFlag& stop) {
  std::unique_ptr<std::FILE, CloseFile> log;
  if (!options.log_path.empty()) {
    log.reset(std::fopen(options.log_path.c_str(), "w"));
    if (!log) throw UsageError("--log " + options.log_path + ": cannot be written");
  }
  can::BusServer server(options.bus, options.config);
  spdlog::info("bus '{}' at {}, {:.0f} bit/s", options.bus, server.path(),
               options.config.bitrate_bit_s);

  const std::int64_t shift_ns = EpochShift_ns();
  bool log_failed = false;
  server.OnFrame([&](const can::Delivery& delivery) {
    if (!log || log_failed) return;
    const std::string line =
        can::FormatCandump({delivery.end_ns + shift_ns, options.bus, delivery.frame}) + '\n';
    log_failed = std::fputs(line.c_str(), log.get()) == EOF;
    if (log_failed) spdlog::error("--log {}: cannot be written any more", options.log_path);
  });
  std::int64_t next_flush_ns = 0;
  node::BeginRealtime();
  while (!stop.requested()) {
    server.RunOnce(std::chrono::milliseconds(50));
    if (log && !log_failed && types::MonotonicNow_ns() > next_flush_ns) {
      next_flush_ns = types::MonotonicNow_ns() + 200'000'000;
      log_failed = std::fflush(log.get()) != 0;
      if (log_failed) spdlog::error("--log {}: cannot be written any more", options.log_path);
    }
  }
  const can::BusCounters& counters = server.counters();
  spdlog::info("{} frames, {} error frames, {} refused, {} lost by clients", counters.frames,
               counters.error_frames, counters.refused, server.lost());
  if (log_failed) throw std::runtime_error("--log " + options.log_path + ": incomplete");
}

}  // namespace

int main(int argc, char** argv) {
  BusOptions options;
  return node::RunParticipant(
      argc, argv, "can-bus", "A CAN bus between processes: arbitration, bit stuffing, bit timing",
      [&](const node::Options&, node::StopFlag& stop) { Run(options, stop); },
      [&](CLI::App& app) {
        app.add_option("--bus", options.bus, "Name of the bus, or path of its socket")
            ->capture_default_str();
        app.add_option("--bitrate", options.config.bitrate_bit_s, "Bits per second")
            ->check(CLI::Range(10e3, 1e6))
            ->capture_default_str();
        app.add_option("--queue", options.config.queue_frames, "Frames that wait at each node")
            ->check(CLI::Range(1, 1000))
            ->capture_default_str();
        app.add_option("--log", options.log_path, "Writes every frame, as candump -l does");
      });
}
