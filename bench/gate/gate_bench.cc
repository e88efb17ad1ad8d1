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

struct Totals {
  std::map<std::string, Count> found, stopped, left_out;
  std::map<std::string, double> largest;  // of the statistics without a fault, over their limits
};

struct Recording {
  std::size_t number;
  std::string text;  // "stribeck at 50 Hz, task, seed 4"
  bool task, with_effect;
  scene::Recorded recorded;
};

Recording Record(std::size_t number, const std::string& name, int first_seed, double seconds) {
  const Rate& rate = kRates[number % std::size(kRates)];
  const bool task = number % 3 == 2;
  scene::Scene scene;
  scene.seed = static_cast<std::uint64_t>(first_seed) + number;
  scene.excitation = task ? surrogate::ExcitationKind::kTask : surrogate::ExcitationKind::kDesigned;
  scene.trains = 2;
  scene.seconds = seconds;
  scene.held_out = false;
  scene.cycle_Hz = rate.cycle_Hz;
  scene.log_every = rate.log_every;
  if (name != "none") {
    const auto effect = surrogate::ParseEffect(name);
    scene.effects = {*effect};
  }
  return {number,
          name + " at " + std::to_string(static_cast<int>(rate.rate_Hz())) + " Hz" +
              (task ? ", task" : "") + ", seed " + std::to_string(scene.seed),
          task, name != "none", scene::Record(scene)};
}

void CountSound(const Recording& what, bool verbose, Totals* totals) {
  const gate::GateReport sound = gate::ExamineData(what.recorded.train, what.recorded.declared);
  const std::string row = what.with_effect ? "with an effect" : "without an effect";
  Count& count = totals->stopped[row];
  ++count.all;
  count.right += sound.stops();
  for (const gate::Fault& fault : sound.faults) {
    std::cout << "FALSE STOP " << what.text << ": " << gate::FormatFault(fault) << " ("
              << fault.statistic << ")\n";
  }
  Count& rows = totals->left_out[row];
  ++rows.all;
  rows.right += !sound.left_out.empty();
  for (const gate::Finding& at : sound.findings) {
    if (at.name == gate::kLeftOutRows)
      std::cout << "LEFT OUT " << what.text << ": " << at.text << '\n';
  }
  for (const gate::Measurement& at : sound.largest) {
    double& most = totals->largest[at.rule];
    most = std::max(most, at.statistic);
    if (verbose && at.statistic > 0.6 * at.limit && at.limit > 0.0) {
      std::cout << "near " << what.text << ": " << at.rule << ' ' << at.signal << ' '
                << at.statistic << '\n';
    }
  }
}

// A third of the faults in every scene: each meets every rate, effect and motion in turn.
void CountFaults(const Recording& what, bool verbose, Totals* totals) {
  for (std::size_t f = what.number / 3 % 3; f < gate::FaultKinds().size(); f += 3) {
    const gate::FaultKind& kind = gate::FaultKinds()[f];
    if (kind.needs_hand && what.task) continue;
    scene::Recorded faulty = what.recorded;
    gate::Plant(kind.name, 77 * what.number + f, &faulty.train, &faulty.declared);
    const gate::GateReport report = gate::ExamineData(faulty.train, faulty.declared);
    const bool right = gate::IsFound(kind, report);
    ++totals->found[kind.name].all;
    totals->found[kind.name].right += right;
    if (right || !verbose) continue;
    std::cout << "MISSED " << kind.name << " in " << what.text << ':';
    for (const gate::Measurement& at : report.largest) {
      if (std::find(kind.rules.begin(), kind.rules.end(), at.rule) != kind.rules.end()) {
        std::cout << ' ' << at.rule << ' ' << at.signal << ' ' << at.statistic;
      }
    }
    for (const gate::Fault& fault : report.faults) std::cout << " [" << fault.rule << "]";
    std::cout << '\n';
  }
}

void PrintRows(const std::map<std::string, Count>& counts) {
  for (const auto& [name, count] : counts) {
    std::cout << "| " << name << " | " << Share(count.right, count.all) << " |\n";
  }
}

void Print(Totals totals) {
  std::cout << "| planted | found |\n| --- | --- |\n";
  PrintRows(totals.found);
  Count all;
  for (const auto& [name, count] : totals.found) {
    all.right += count.right;
    all.all += count.all;
  }
  if (all.all > 0) std::cout << "| all | " << Share(all.right, all.all) << " |\n";
  std::cout << "\n| false stops | |\n| --- | --- |\n";
  PrintRows(totals.stopped);
  std::cout << "\n| rows left out without a spike | |\n| --- | --- |\n";
  PrintRows(totals.left_out);
  std::cout << "\n| rule | limit | largest without a fault |\n| --- | --- | --- |\n";
  for (const gate::Rule& rule : gate::Rules()) {
    std::cout << "| " << rule.id << " | " << rule.limit << " | "
              << totals.largest[std::string(rule.id)] << " |\n";
  }
}

void Run(int seeds, int first_seed, double seconds, bool verbose, bool faults) {
  Totals totals;
  std::vector<std::string> scenes = {"none"};
  for (const surrogate::EffectInfo& effect : surrogate::UndeclaredEffects()) {
    scenes.emplace_back(effect.name);
  }
  for (int k = 0; k < seeds; ++k) {
    for (std::size_t s = 0; s < scenes.size(); ++s) {
      const auto number = static_cast<std::size_t>(k) * scenes.size() + s;
      const Recording what = Record(number, scenes[s], first_seed, seconds);
      CountSound(what, verbose, &totals);
      if (faults) CountFaults(what, verbose, &totals);
    }
    std::cerr << "seed " << k + 1 << " of " << seeds << '\n';
  }
  Print(totals);
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
