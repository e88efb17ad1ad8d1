// Random signals to the processes of a rig behind its bus: bench/signals/README.md.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <exception>
#include <string>
#include <vector>

#include "bench/signals/soak.h"

namespace {

using namespace sinew;

void PrintFirst(const std::vector<std::string>& lines) {
  constexpr std::size_t kMost = 20;
  for (std::size_t i = 0; i < std::min(lines.size(), kMost); ++i) {
    std::printf("  %s\n", lines[i].c_str());
  }
}

void Print(const signals::Outcome& outcome) {
  std::printf("%.0f s, moving %.0f s; %d SIGKILL, %d SIGSTOP, %d SIGCONT; %d launches, %d stuck\n",
              outcome.seconds, outcome.moving_s, outcome.kills, outcome.stops, outcome.continues,
              outcome.launches, outcome.stuck);
  std::printf("%d switches between who is obeyed; signals to:", outcome.switches);
  for (const auto& [name, count] : outcome.signals) std::printf(" %s %d", name.c_str(), count);
  const signals::Findings& bus = outcome.bus;
  std::printf(
      "\n%llu torque setpoints, %llu of them commands; oldest %.1f ms (goal 20.8); longest in "
      "closed loop without a command %.0f ms (goal 264)\n",
      static_cast<unsigned long long>(bus.setpoints), static_cast<unsigned long long>(bus.matched),
      bus.oldest_ms, bus.longest_without_ms);
  std::printf("a witness of the highest priority was over 1 ms late in %.1f %% of the time\n",
              100.0 * static_cast<double>(bus.late_windows) /
                  static_cast<double>(std::max<std::uint64_t>(bus.windows, 1)));
  std::printf("/dev/shm: %zu files with %.1f MB before, %zu with %.1f MB after\n",
              outcome.before.files, 1e-6 * static_cast<double>(outcome.before.bytes),
              outcome.after.files, 1e-6 * static_cast<double>(outcome.after.bytes));
  for (const auto& [name, grown] : outcome.grown) {
    std::printf("%-14s grew by at most %6lld kB within %6.0f s, and %lld open files\n",
                name.c_str(), static_cast<long long>(grown.memory_kB), grown.lived_s,
                static_cast<long long>(grown.files));
  }
  std::printf("%zu violations on the bus, %zu beside it\n", bus.violations.size(),
              outcome.violations.size());
  PrintFirst(bus.violations);
  PrintFirst(outcome.violations);
}

}  // namespace

int main(int argc, char** argv) {
  signals::Wanted wanted;
  bool ordinary = false;
  CLI::App app("Random SIGKILL, SIGSTOP and SIGCONT to the processes of a rig that moves");
  app.add_option("--seconds", wanted.seconds, "How long")->capture_default_str();
  app.add_option("--signals", wanted.signals, "How many in that time")->capture_default_str();
  app.add_option("--seed", wanted.seed, "Of the random numbers")->capture_default_str();
  app.add_option("--domain", wanted.domain, "DDS domain")->capture_default_str();
  app.add_flag("--ordinary", ordinary, "Without real-time priority");
  CLI11_PARSE(app, argc, argv);
  wanted.realtime = !ordinary;
  try {
    const signals::Outcome outcome = signals::Soak(wanted).Run();
    Print(outcome);
    return outcome.bus.violations.empty() && outcome.violations.empty() ? 0 : 1;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "signals_soak: %s\n", error.what());
    return 1;
  }
}
