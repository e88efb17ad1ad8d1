// lcm-logger on the same bytes at the same rate: written as an LCM log, sent by lcm-logplayer.
//
// Format of the log (lcm/eventlog.c of LCM 1.3.1), big-endian: sync word, event number, time in us,
// length of the channel's name, length of the data, both.
#include <signal.h>

#include <chrono>
#include <cstdio>
#include <fstream>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "bench/logger/measures.h"
#include "bench/logger/process_cpu.h"
#include "bench/logger/traffic.h"
#include "tools/launch/program.h"

namespace sinew::logger_bench {

namespace {

constexpr std::uint32_t kLcmSync = 0xEDA1DA01;
constexpr std::uint64_t kLcmHead = 28;

template <class T>
void PutBig(std::string* out, T value) {
  for (int shift = 8 * (static_cast<int>(sizeof(T)) - 1); shift >= 0; shift -= 8) {
    out->push_back(static_cast<char>(value >> shift));
  }
}

std::uint64_t WriteLcmLog(const std::filesystem::path& file, double rate_Hz, double seconds) {
  std::vector<std::unique_ptr<ZeroMessage>> messages;
  for (const std::string& topic : RigTopics()) {
    messages.push_back(std::make_unique<ZeroMessage>(*node::FindTopic(topic)));
  }
  std::ofstream out(file, std::ios::binary);
  std::uint64_t events = 0;
  std::string event;
  for (std::uint64_t tick = 0; static_cast<double>(tick) < rate_Hz * seconds; ++tick) {
    for (std::size_t i = 0; i < messages.size(); ++i) {
      const recording::Bytes& bytes = messages[i]->At(tick, 0);
      const std::string& channel = RigTopics()[i];
      event.clear();
      PutBig(&event, kLcmSync);
      PutBig(&event, events++);
      PutBig(&event, static_cast<std::uint64_t>(1e6 * static_cast<double>(tick) / rate_Hz));
      PutBig(&event, static_cast<std::uint32_t>(channel.size()));
      PutBig(&event, static_cast<std::uint32_t>(bytes.size()));
      event += channel;
      event.append(reinterpret_cast<const char*>(bytes.data()), bytes.size());
      out << event;
    }
  }
  return events;
}

std::uint64_t CountLcmEvents(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::uint64_t events = 0;
  std::vector<unsigned char> head(kLcmHead);
  while (in.read(reinterpret_cast<char*>(head.data()), static_cast<std::streamsize>(kLcmHead))) {
    const auto length = [&head](std::size_t at) {
      return (static_cast<std::uint32_t>(head[at]) << 24) | (head[at + 1] << 16) |
             (head[at + 2] << 8) | head[at + 3];
    };
    in.seekg(static_cast<std::streamoff>(length(20)) + length(24), std::ios::cur);
    ++events;
  }
  return events;
}

}  // namespace

bool MeasureLcm(const CpuOptions& options) {
  const std::filesystem::path sent = options.folder / "sent.lcm";
  const std::filesystem::path recorded = options.folder / "recorded.lcm";
  const std::uint64_t events = WriteLcmLog(sent, options.rate_Hz, options.seconds);
  std::filesystem::remove(recorded);
  launch::Program logger({"lcm-logger", recorded.string()});
  std::this_thread::sleep_for(std::chrono::seconds(1));  // it says nothing when it listens
  const double before = CpuOf_s(logger.pid());
  const launch::Finished player = launch::Run(
      {"lcm-logplayer", sent.string()},
      std::chrono::milliseconds(static_cast<int>(1000.0 * (3.0 * options.seconds + 30.0))));
  if (player.exit_code != 0) throw std::runtime_error("lcm-logplayer: " + player.error);
  const double cpu_s = CpuOf_s(logger.pid()) - before;
  logger.Signal(SIGINT);
  logger.Wait(std::chrono::seconds(20));
  const std::uint64_t got = CountLcmEvents(recorded);
  std::printf("lcm-logger               %6.1f %% of a core\n", 100.0 * cpu_s / options.seconds);
  std::printf("%llu of %llu messages recorded\n", static_cast<unsigned long long>(got),
              static_cast<unsigned long long>(events));
  return true;  // no goal: another program's figures
}

}  // namespace sinew::logger_bench
