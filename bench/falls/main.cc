// falls: provoked falls and healthy squats of robots/biped with its guard. Exit code 1 when a fall
// was missed, joints were not in the declared state, or a healthy squat was an alarm.
#include <CLI/CLI.hpp>
#include <exception>
#include <iostream>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "bench/falls/table.h"

namespace {

using namespace sinew;
constexpr int kDrawsARun = 4;  // at most: what did not fall, or was no healthy squat

struct ProgramOptions {
  falls::ProvokeOptions provoke{.root = SINEW_SOURCE_DIR};
  int falls = 100, squats = 100;
  std::uint64_t seed = 1;
};

// Runs until `wanted` count, in the order of the numbers; prints each.
template <class Run, class Draw, class Make>
std::vector<Run> Collect(int wanted, const char* not_counted, const Draw& draw, const Make& make) {
  std::vector<Run> runs;
  std::map<std::string, int> left_out;
  for (int number = 0; number < kDrawsARun * wanted && static_cast<int>(runs.size()) < wanted;
       ++number) {
    const falls::Scenario scenario = draw(number);
    if (const std::optional<Run> run = make(scenario)) {
      falls::Print(*run, std::cout);
      runs.push_back(*run);
      continue;
    }
    ++left_out[std::string(KindName(scenario.kind)) + ", " +
               std::string(ControllerName(scenario.controller))];
  }
  for (const auto& [kind, count] : left_out) {
    std::cout << count << " of " << kind << " not counted: " << not_counted << '\n';
  }
  return runs;
}

int Main(const ProgramOptions& options) {
  const auto fallen = Collect<falls::FallRun>(
      options.falls, "no fall by the truth",
      [&](int number) { return falls::DrawFall(options.seed, number); },
      [&](const falls::Scenario& scenario) {
        return falls::ProvokeFall(scenario, options.provoke);
      });
  const auto squats = Collect<falls::SquatRun>(
      options.squats, "a fall by the truth",
      [&](int number) { return falls::DrawSquats(options.seed, number); },
      [&](const falls::Scenario& scenario) {
        return falls::WatchSquats(scenario, options.provoke);
      });
  std::cout << '\n';
  const bool good = falls::PrintTable(fallen, squats, std::cout);
  const bool complete = static_cast<int>(fallen.size()) == options.falls &&
                        static_cast<int>(squats.size()) == options.squats;
  if (!complete) std::cout << "fewer runs than asked for\n";
  return good && complete ? EXIT_SUCCESS : EXIT_FAILURE;
}

}  // namespace

int main(int argc, char** argv) try {
  ProgramOptions options;
  CLI::App app("Provoked falls and healthy squats of the simulated biped with its guard.");
  app.add_option("--falls", options.falls, "Falls to provoke")->check(CLI::NonNegativeNumber);
  app.add_option("--squats", options.squats, "Healthy squats")->check(CLI::NonNegativeNumber);
  app.add_option("--seed", options.seed, "Number of the first run; the others follow");
  app.add_option(
         "--damp", options.provoke.damping_Nm_s_rad,
         "on_fall: damp with this damping, Nm s/rad of the motor, instead of the file's policy")
      ->check(CLI::NonNegativeNumber);
  app.add_option("--after", options.provoke.after_s, "Seconds that a run goes on after a fault")
      ->check(CLI::NonNegativeNumber);
  app.add_option("--root", options.provoke.root, "Folder of the project");
  CLI11_PARSE(app, argc, argv);
  if (options.provoke.damping_Nm_s_rad) options.provoke.on_fall = provider::FallPolicy::kDamp;
  return Main(options);
} catch (const std::exception& error) {
  std::cerr << "falls: " << error.what() << '\n';
  return 2;
}
