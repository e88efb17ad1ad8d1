// sinew-surrogate-csv: a recording of the surrogate rig as the lab's CSV, without any topics.
#include <CLI/CLI.hpp>
#include <cstdint>
#include <filesystem>
#include <iostream>
#include <stdexcept>
#include <string>
#include <vector>

#include "components/base/config/config.h"
#include "sim/surrogate/excitation.h"
#include "sim/surrogate/experiment.h"
#include "sim/surrogate/file/rows_csv.h"
#include "sim/surrogate/file/surrogate_file.h"

namespace {

struct Options {
  std::filesystem::path out;
  std::filesystem::path config;
  double seconds = 90.0;
  std::string excitation = "designed";
  std::vector<std::string> effects;
  double payload_kg = 0.0;
  double spread = -1.0;
  std::uint64_t seed = 1;
  std::uint64_t rig_seed = 0;
  double lost_share = 0.004;
  double jitter_s = 4e-4;
  bool list_effects = false;
};

void Run(const Options& options) {
  using namespace sinew::surrogate;
  RigParameters rig = LoadRig(options.config);
  if (!options.effects.empty()) rig.effects = ParseEffects(options.effects);
  if (options.spread >= 0.0) rig.spread = options.spread;
  try {
    // The specimen comes from its own seed, so that several recordings can be of one rig.
    rig.seed = options.rig_seed != 0 ? options.rig_seed : options.seed;
    rig = Specimen(rig);
    rig.seed = options.seed;
    rig.link.declared_payload_kg = options.payload_kg;
    const PneumaticLine line = LinePneumatics(rig);
    const Excitation excitation({.kind = ParseExcitation(options.excitation),
                                 .duration_s = options.seconds,
                                 .payload_kg = options.payload_kg,
                                 .pneumatic_Nm_bar = line.slope_Nm_bar,
                                 .pneumatic_stiffness_Nm_rad_bar = line.stiffness_Nm_rad_bar,
                                 .seed = options.seed});
    excitation.Prepare(&rig);
    const std::vector<LogRow> rows = RunExperiment(rig,
                                                   {.duration_s = options.seconds,
                                                    .jitter_s = options.jitter_s,
                                                    .lost_share = options.lost_share,
                                                    .seed = options.seed},
                                                   excitation);
    sinew::config::WriteFileAtomically(options.out, RowsToCsv(rows));
    std::cout << options.out.string() << ": " << rows.size() << " rows, " << options.seconds
              << " s\n";
  } catch (const std::invalid_argument& error) {
    throw sinew::UsageError(error.what());
  }
}

}  // namespace

int main(int argc, char** argv) try {
  Options options;
  CLI::App app{"Records the surrogate rig in process and writes the lab's CSV (80 Hz)."};
  app.add_option("--out,-o", options.out, "CSV file to write");
  app.add_option("--config,-c", options.config,
                 "configuration of the surrogate (sinew-surrogate/1)");
  app.add_option("--seconds", options.seconds, "length of the recording")
      ->check(CLI::Range(1.0, 86400.0))
      ->capture_default_str();
  app.add_option("--excitation", options.excitation, "designed, task, sea (5.1.2) or pea (5.1.3)")
      ->capture_default_str();
  app.add_option("--effect", options.effects,
                 "undeclared effect, NAME, NAME=SIZE or NAME=SIZE@SECONDS; may be repeated");
  app.add_option("--payload", options.payload_kg, "declared payload, kg")
      ->check(CLI::Range(0.0, 20.0));
  app.add_option("--spread", options.spread, "the rig's parameters are off by up to this share")
      ->check(CLI::Range(0.0, 0.3));
  app.add_option("--seed", options.seed, "of noise and excitation")->capture_default_str();
  app.add_option("--rig-seed", options.rig_seed, "of the spread; 0: the same as --seed");
  app.add_option("--lost-share", options.lost_share, "share of rows that never arrive")
      ->check(CLI::Range(0.0, 0.5));
  app.add_option("--jitter", options.jitter_s, "standard deviation of a cycle's instant, s")
      ->check(CLI::Range(0.0, 0.002));
  app.add_flag("--list-effects", options.list_effects, "print the effects and leave");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    const int code = app.exit(error);
    return code == 0 ? 0 : 2;
  }
  if (options.list_effects) {
    std::cout << sinew::surrogate::DescribeEffects();
    return 0;
  }
  if (options.out.empty())
    throw sinew::UsageError("--out: no file given, expected a CSV file to write");
  Run(options);
  return 0;
} catch (const sinew::UsageError& error) {
  std::cerr << error.what() << '\n';
  return 2;
} catch (const std::exception& error) {
  std::cerr << error.what() << '\n';
  return 1;
}
