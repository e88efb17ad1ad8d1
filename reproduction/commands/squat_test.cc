#include "reproduction/commands/squat_test.h"

#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <vector>

#include "components/base/config/config.h"
#include "components/base/types/json_text.h"
#include "components/model/report/file/section_file.h"
#include "reproduction/squat_test/photographs.h"
#include "reproduction/squat_test/section.h"
#include "tools/sinew/print_section.h"
#include "tools/sinew/progress.h"
#include "tools/sinew/shipped.h"

namespace sinew::reproduction {
namespace {

namespace fs = std::filesystem;

struct SquatTestOptions {
  fs::path robot;
  fs::path out;
  int domain_id = 0;
  bool quick = false;
  bool json = false;
};

struct PlannedSquats {
  const squat_test::Arm* arm;
  squat_test::Load load;
};

std::vector<PlannedSquats> PlanSquats(bool quick) {
  std::vector<PlannedSquats> plan;
  for (const squat_test::Arm& arm : squat_test::Arms()) {
    const bool needed = arm.id == "pid" || arm.id == "pid-esn" || arm.id == "computed-torque";
    if (!quick || needed) plan.push_back({&arm, squat_test::Load::kNone});
    const bool loaded = arm.id == "computed-torque" || arm.id == "adapted";
    if (!quick || loaded) plan.push_back({&arm, squat_test::Load::kFromStart});
  }
  for (const squat_test::Arm& arm : squat_test::Arms()) {
    if (arm.six_squats && !quick) plan.push_back({&arm, squat_test::Load::kPutOn});
  }
  return plan;
}

nlohmann::ordered_json SquatsJson(const squat_test::Squats& squats) {
  nlohmann::ordered_json json = {
      {"control", squats.arm->id},
      {"load", squats.load == squat_test::Load::kNone        ? "none"
               : squats.load == squat_test::Load::kFromStart ? "4 kg from the start"
                                                             : "4 kg after the third squat"},
      {"squats", squats.count},
      {"mse_rad2", squats.mse_rad2}};
  if (squats.fall_s) json["fall_s"] = *squats.fall_s;
  json["performance"] = tools::PerformanceJson(squats.session)["robot"];
  if (squats.load == squat_test::Load::kPutOn && !squats.fall_s) {
    const squat_test::Recovery recovery = squat_test::RecoveryOf(squats);
    json["before_rad"] = recovery.before_rad;
    json["after_rad"] = recovery.after_rad;
    if (recovery.settled_s) json["settled_s"] = *recovery.settled_s;
  }
  return json;
}

// The first of the runs, which is one without load, from two sides, before the other pictures.
void AddPhotographs(const squat_test::Squats& squats, const fs::path& urdf, const fs::path& folder,
                    report::Section* section) {
  const char* names[] = {"side", "front"};
  const render::View views[] = {render::View::kSide, render::View::kThreeQuarter};
  for (std::size_t n = 0; n < 2; ++n) {
    report::Picture picture =
        squat_test::PhotographSquat(squats.file, urdf, folder / names[n], views[n]);
    picture.title = "A squat, " + squats.arm->title +
                    (n == 0 ? ", from the side" : ", from the front") + " (Figs 6.15, 6.16)";
    picture.caption = "Drawn from the recording; the time is that of the recording.";
    section->pictures.insert(section->pictures.begin() + static_cast<std::ptrdiff_t>(n), picture);
  }
}

void RunSquatTest(const SquatTestOptions& options) {
  const auto start = std::chrono::steady_clock::now();
  squat_test::RunnerConfig config;
  config.robot = options.robot.empty() ? tools::ShippedRobotFile("biped") : options.robot;
  config.folder = options.out / "runs";
  config.domain_id = options.domain_id;
  if (!fs::exists(config.robot / "squat_test")) {
    throw UsageError("--robot " + config.robot.string() +
                     ": no folder squat_test in it, expected robots/biped");
  }
  const std::vector<PlannedSquats> plan = PlanSquats(options.quick);
  std::vector<squat_test::Squats> benchmark, six;
  tools::ProgressBar bar("squat-test", "runs", plan.size());
  std::uint64_t done = 0;
  for (const PlannedSquats& planned : plan) {
    squat_test::Squats squats = squat_test::RunSquats(config, *planned.arm, planned.load);
    (planned.load == squat_test::Load::kPutOn ? six : benchmark).push_back(std::move(squats));
    bar.Update(++done);
  }
  bar.Finish();
  report::Section section = squat_test::MakeSection(benchmark, six);
  AddPhotographs(benchmark.front(), config.robot / "biped.urdf", options.out / "photographs",
                 &section);
  section.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  report::WriteSection(options.out, section);
  if (options.json) {
    nlohmann::ordered_json all = nlohmann::ordered_json::array();
    for (const squat_test::Squats& squats : benchmark) all.push_back(SquatsJson(squats));
    for (const squat_test::Squats& squats : six) all.push_back(SquatsJson(squats));
    std::cout << types::JsonText(all, 2) << '\n';
    return;
  }
  tools::PrintSection(section);
  std::printf("\n%s written, %.0f s\n", (options.out / "section.json").c_str(), section.seconds);
}

}  // namespace

void AddSquatTestCommand(CLI::App& app) {
  auto options = std::make_shared<SquatTestOptions>();
  CLI::App* command = app.add_subcommand(
      "squat-test", "Compare control strategies on the biped's squats, with and without 4 kg");
  command
      ->add_option("--robot", options->robot,
                   "Folder of the robot's files; default: robots/biped that comes with the program")
      ->check(CLI::ExistingDirectory);
  command
      ->add_option("--out", options->out,
                   "Folder for recordings and the section of a page; runs that are there already "
                   "are not made again")
      ->required();
  command->add_option("--domain", options->domain_id, "DDS domain, 0 to 232")
      ->check(CLI::Range(0, 232))
      ->envname("SINEW_DOMAIN")
      ->capture_default_str();
  command->add_flag("--quick", options->quick, "Five runs instead of seventeen: half a minute");
  command->add_flag("--json", options->json, "Scores of all runs as JSON");
  command->footer(
      "Examples:\n"
      "  sinew squat-test --out results/squats\n"
      "  sinew squat-test --quick --json --out quick");
  command->callback([options] { RunSquatTest(*options); });
}

}  // namespace sinew::reproduction
