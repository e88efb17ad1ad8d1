// payload_soak: mutated payloads of every topic into every participant. Exit code 1 when a property
// does not hold.
#include <spdlog/sinks/null_sink.h>
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdio>

#include "bench/payloads/soak.h"

namespace {

using namespace sinew;
using Clock = std::chrono::steady_clock;

constexpr std::uint64_t kChunk = 20'000;  // between looks at the clock

struct ProgramOptions {
  std::uint64_t payloads = 1'000'000;
  double seconds = 0.0;  // 0: no limit
  std::string group;
  std::string root = SINEW_SOURCE_DIR;
  payloads::SoakOptions soak;
};

void Print(const payloads::Group& group, const payloads::Soak& soak, double seconds) {
  std::printf("group %s: %llu mutated payloads, %llu cycles, %.1f s, %.0f payloads/s\n",
              group.name.c_str(), static_cast<unsigned long long>(soak.payloads()),
              static_cast<unsigned long long>(soak.cycles()), seconds,
              static_cast<double>(soak.payloads()) / seconds);
  std::printf("  %-20s %12s %12s %8s %12s %12s\n", "topic", "mutated", "well-formed", "readers",
              "received", "malformed");
  for (const payloads::TopicCount& topic : soak.topics()) {
    std::printf("  %-20s %12llu %12llu %8d %12llu %12llu\n", topic.topic.c_str(),
                static_cast<unsigned long long>(topic.mutated),
                static_cast<unsigned long long>(topic.well_formed), topic.readers,
                static_cast<unsigned long long>(topic.received),
                static_cast<unsigned long long>(topic.malformed));
  }
  for (const payloads::MemberCount& member : soak.members()) {
    std::printf("  %-20s %12llu steps, %llu sessions ended\n", member.name.c_str(),
                static_cast<unsigned long long>(member.steps),
                static_cast<unsigned long long>(member.ended));
  }
  for (const payloads::Defect& defect : soak.defects()) {
    std::printf("  DEFECT %s: %s (%llu times, first in cycle %llu)\n", defect.member.c_str(),
                defect.what.c_str(), static_cast<unsigned long long>(defect.times),
                static_cast<unsigned long long>(defect.cycle));
  }
  std::fflush(stdout);
}

// Number of defects.
std::size_t Run(const payloads::Group& group, const ProgramOptions& options, double seconds,
                std::uint64_t payloads) {
  payloads::Soak soak(group, options.soak);
  const auto begin = Clock::now();
  const auto passed_s = [&] { return std::chrono::duration<double>(Clock::now() - begin).count(); };
  while (!soak.stopped() && soak.payloads() < payloads &&
         (seconds <= 0.0 || passed_s() < seconds)) {
    soak.Run(std::min(kChunk, payloads - soak.payloads()));
  }
  Print(group, soak, passed_s());
  return soak.defects().size();
}

}  // namespace

int main(int argc, char** argv) {
  ProgramOptions options;
  CLI::App app("Mutated payloads of every topic into every participant.", "payload_soak");
  app.add_option("--payloads", options.payloads, "Mutated payloads, of all groups together");
  app.add_option("--seconds", options.seconds, "Ends earlier than that; 0: no limit");
  app.add_option("--seed", options.soak.seed, "Of all that is drawn");
  app.add_option("--topic", options.soak.topic, "Mutates this topic alone");
  app.add_option("--group", options.group, "Runs this group alone");
  app.add_option("--root", options.root, "Where robots/ and bench/ are");
  CLI11_PARSE(app, argc, argv);
  // Every line is made, and nobody reads it.
  spdlog::set_default_logger(
      std::make_shared<spdlog::logger>("", std::make_shared<spdlog::sinks::null_sink_mt>()));
  const std::filesystem::path root = options.root;
  std::vector<payloads::Group> groups =
      payloads::AllGroups(root / "bench/payloads", root / "robots/rig");
  if (!options.group.empty()) {
    std::erase_if(groups,
                  [&](const payloads::Group& group) { return group.name != options.group; });
  }
  std::size_t defects = 0;
  const node::StopFlag stop;
  for (const payloads::Group& group : groups) {
    if (stop.requested()) break;
    const auto count = static_cast<double>(groups.size());
    defects += Run(group, options, options.seconds / count, options.payloads / groups.size());
  }
  return defects == 0 ? 0 : 1;
}
