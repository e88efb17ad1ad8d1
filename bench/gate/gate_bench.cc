// gate-bench: data faults planted into recordings of the surrogate, how many the gate finds, and
// how often it stops without one.
//   cmake --build build/release --target gate_bench
//   build/release/bin/gate_bench --seeds 4
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <iostream>
#include <map>
#include <string>
#include <vector>

#include "bench/rigs/figures.h"
#include "components/model/gate/gate.h"
#include "components/model/gate/rules.h"
#include "tests/components/model/gate/plant.h"
#include "tests/components/model/gate/scene.h"

namespace {

using namespace sinew;

struct Rate {
  double cycle_Hz;
  int log_every;
  double rate_Hz() const { return cycle_Hz / log_every; }
};
constexpr Rate kRates[] = {{250.0, 5}, {240.0, 3}, {400.0, 2}, {500.0, 1}, {1000.0, 1}};

// "38 of 40, 95 % [83, 99]": the exact interval of Clopper and Pearson (1934).
std::string Share(int k, int n) {
  const auto [low, high] = rig_bank::ClopperPearson(k, n);
  char text[120];
  std::snprintf(text, sizeof text, "%d of %d, %.1f %% [%.1f, %.1f]", k, n,
                n > 0 ? 100.0 * k / n : 0.0, 100.0 * low, 100.0 * high);
  return text;
}

struct Count {
  int right = 0, all = 0;
};

void Run(int seeds, int first_seed, double seconds, bool verbose, bool faults) {
  std::map<std::string, Count> found, stopped, left_out;
  std::map<std::string, double> largest;  // of the statistics without a fault, over their limits
  std::vector<std::string> scenes = {"none"};
  for (const surrogate::EffectInfo& effect : surrogate::UndeclaredEffects()) {
    scenes.emplace_back(effect.name);
  }
  for (int k = 0; k < seeds; ++k) {
    for (std::size_t s = 0; s < scenes.size(); ++s) {
      const auto number = static_cast<std::size_t>(k) * scenes.size() + s;
      const Rate& rate = kRates[number % std::size(kRates)];
      scene::Scene scene;
      scene.seed = static_cast<std::uint64_t>(first_seed) + number;
      scene.excitation =
          number % 3 == 2 ? surrogate::ExcitationKind::kTask : surrogate::ExcitationKind::kDesigned;
      scene.trains = 2;
      scene.seconds = seconds;
      scene.held_out = false;
      scene.cycle_Hz = rate.cycle_Hz;
      scene.log_every = rate.log_every;
      if (scenes[s] != "none") {
        const auto effect = surrogate::ParseEffect(scenes[s]);
        scene.effects = {*effect};
      }
      const scene::Recorded recorded = scene::Record(scene);
      const std::string what =
          scenes[s] + " at " + std::to_string(static_cast<int>(rate.rate_Hz())) + " Hz" +
          (scene.excitation == surrogate::ExcitationKind::kTask ? ", task" : "") + ", seed " +
          std::to_string(scene.seed);
      const gate::GateReport sound = gate::ExamineData(recorded.train, recorded.declared);
      Count& count = stopped[scenes[s] == "none" ? "without an effect" : "with an effect"];
      ++count.all;
      count.right += sound.stops();
      for (const gate::Fault& fault : sound.faults) {
        std::cout << "FALSE STOP " << what << ": " << gate::FormatFault(fault) << " ("
                  << fault.statistic << ")\n";
      }
      Count& rows = left_out[scenes[s] == "none" ? "without an effect" : "with an effect"];
      ++rows.all;
      rows.right += !sound.left_out.empty();
      for (const identify::Finding& at : sound.findings) {
        if (at.name == gate::kLeftOutRows)
          std::cout << "LEFT OUT " << what << ": " << at.text << '\n';
      }
      for (const gate::Measurement& at : sound.largest) {
        double& most = largest[at.rule];
        most = std::max(most, at.statistic);
        if (verbose && at.statistic > 0.6 * at.limit && at.limit > 0.0) {
          std::cout << "near " << what << ": " << at.rule << ' ' << at.signal << ' ' << at.statistic
                    << '\n';
        }
      }
      if (!faults) continue;
      // A third of the faults in every scene: each meets every rate, effect and motion in turn.
      for (std::size_t f = number / 3 % 3; f < gate::FaultKinds().size(); f += 3) {
        const gate::FaultKind& kind = gate::FaultKinds()[f];
        if (kind.needs_hand && scene.excitation == surrogate::ExcitationKind::kTask) continue;
        scene::Recorded faulty = recorded;
        gate::Plant(kind.name, 77 * number + f, &faulty.train, &faulty.declared);
        const gate::GateReport report = gate::ExamineData(faulty.train, faulty.declared);
        const bool right = gate::IsFound(kind, report);
        ++found[kind.name].all;
        found[kind.name].right += right;
        if (!right && verbose) {
          std::cout << "MISSED " << kind.name << " in " << what << ':';
          for (const gate::Measurement& at : report.largest) {
            if (std::find(kind.rules.begin(), kind.rules.end(), at.rule) != kind.rules.end()) {
              std::cout << ' ' << at.rule << ' ' << at.signal << ' ' << at.statistic;
            }
          }
          for (const gate::Fault& fault : report.faults) std::cout << " [" << fault.rule << "]";
          std::cout << '\n';
        }
      }
    }
    std::cerr << "seed " << k + 1 << " of " << seeds << '\n';
  }
  std::cout << "| planted | found |\n| --- | --- |\n";
  Count all;
  for (const auto& [name, count] : found) {
    std::cout << "| " << name << " | " << Share(count.right, count.all) << " |\n";
    all.right += count.right;
    all.all += count.all;
  }
  if (all.all > 0) std::cout << "| all | " << Share(all.right, all.all) << " |\n";
  std::cout << "\n| false stops | |\n| --- | --- |\n";
  for (const auto& [name, count] : stopped) {
    std::cout << "| " << name << " | " << Share(count.right, count.all) << " |\n";
  }
  std::cout << "\n| rows left out without a spike | |\n| --- | --- |\n";
  for (const auto& [name, count] : left_out) {
    std::cout << "| " << name << " | " << Share(count.right, count.all) << " |\n";
  }
  std::cout << "\n| rule | limit | largest without a fault |\n| --- | --- | --- |\n";
  for (const gate::Rule& rule : gate::Rules()) {
    std::cout << "| " << rule.id << " | " << rule.limit << " | " << largest[std::string(rule.id)]
              << " |\n";
  }
}

}  // namespace

int main(int argc, char** argv) try {
  int seeds = 4, first_seed = 1;
  double seconds = 30.0;
  bool verbose = false, no_faults = false;
  CLI::App app{
      "Plants data faults into recordings of the surrogate and counts what the gate finds."};
  app.add_option("--seeds", seeds, "times that every effect is recorded")->capture_default_str();
  app.add_option("--first-seed", first_seed, "of the specimens")->capture_default_str();
  app.add_option("--seconds", seconds, "of each recording")->capture_default_str();
  app.add_flag("--verbose", verbose, "a line for what is missed or nearly stopped");
  app.add_flag("--no-faults", no_faults, "false stops only");
  CLI11_PARSE(app, argc, argv);
  Run(seeds, first_seed, seconds, verbose, !no_faults);
  return 0;
} catch (const std::exception& error) {
  std::cerr << error.what() << '\n';
  return 1;
}
