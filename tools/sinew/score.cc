#include <CLI/CLI.hpp>
#include <iomanip>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "components/base/config/config.h"
#include "components/base/types/json_text.h"
#include "components/base/types/seconds.h"
#include "components/record/recording/file/run_reader.h"
#include "components/topics/node/time_option.h"
#include "tools/sinew/commands.h"
#include "tools/tracking/tracking.h"

namespace sinew::tools {

namespace {

struct ScoreOptions {
  std::vector<std::string> files;
  std::string map;
  int joint = 0;
  double from_s = 0.0;
  bool json = false;
};

struct Scored {
  std::string name;
  bool linear = false;
  double clock_set_back_s = 0.0;
  TrackingScore score;
};

std::vector<Scored> ScoreAll(const ScoreOptions& options) {
  std::vector<Scored> list;
  for (const std::string& file : options.files) {
    const auto runs = recording::ReadRuns(file, options.map, options.joint);
    if (runs.empty()) throw UsageError(file + ": no run of this joint, expected joint_state");
    for (const types::Run& run : runs) {
      try {
        list.push_back({run.name, run.kind == types::JointKind::kPrismatic, run.clock_set_back_s,
                        ScoreTracking(run, options.from_s)});
      } catch (const std::invalid_argument& error) {
        throw UsageError(file + ": " + error.what() +
                         ", expected position and reference_position throughout");
      }
    }
  }
  return list;
}

void PrintText(const std::vector<Scored>& list) {
  for (const Scored& entry : list) {
    const TrackingScore& score = entry.score;
    const char* length = entry.linear ? "m" : "rad";
    std::cout << entry.name << ": tracking mean square error " << std::setprecision(4)
              << score.mean_square_error_rad2 << ' ' << length << "2 (rms " << score.rms_error_rad
              << ' ' << length << ", largest " << score.max_error_rad << ' ' << length << ") over "
              << score.duration_s << " s";
    if (score.has_current) std::cout << "; current rms " << score.rms_current_A << " A";
    if (score.has_torque) {
      std::cout << "; torque rms " << score.rms_torque_Nm << (entry.linear ? " N" : " Nm")
                << ", positive work " << score.positive_work_J << " J";
    }
    if (entry.clock_set_back_s > 0.0) {
      std::cout << "; its clock was set back by " << types::SecondsText(entry.clock_set_back_s)
                << " s";
    }
    std::cout << '\n';
  }
}

void PrintJson(const std::vector<Scored>& list) {
  nlohmann::ordered_json report = nlohmann::ordered_json::array();
  for (const Scored& entry : list) {
    const TrackingScore& score = entry.score;
    const std::string length = entry.linear ? "m" : "rad";
    nlohmann::ordered_json one = {
        {"name", entry.name},
        {"duration_s", score.duration_s},
        {"mean_square_error_" + length + "2", score.mean_square_error_rad2},
        {"rms_error_" + length, score.rms_error_rad},
        {"max_error_" + length, score.max_error_rad}};
    if (score.has_current) one["rms_current_A"] = score.rms_current_A;
    if (score.has_torque) {
      one[entry.linear ? "rms_force_N" : "rms_torque_Nm"] = score.rms_torque_Nm;
      one["positive_work_J"] = score.positive_work_J;
    }
    if (entry.clock_set_back_s > 0.0) one["clock_set_back_s"] = entry.clock_set_back_s;
    report.push_back(std::move(one));
  }
  std::cout << types::JsonText(report, 2) << '\n';
}

}  // namespace

void AddScoreCommand(CLI::App& app) {
  auto options = std::make_shared<ScoreOptions>();
  CLI::App* command =
      app.add_subcommand("score", "Tracking error, current, torque and work of recorded motions");
  command->add_option("recordings", options->files, "Recordings, or CSV files with --map")
      ->required()
      ->type_name("FILE.mcap");
  command->add_option("--map", options->map, "Mapping of a CSV file's columns")
      ->type_name("FILE.yaml");
  command->add_option("--joint", options->joint, "Joint of a recording, from 0")
      ->check(CLI::Range(0, 11))
      ->capture_default_str();
  command->add_option("--from", options->from_s, "Leave out the first seconds of each run")
      ->check(node::IsTime(node::Zero::kAllowed))
      ->capture_default_str();
  command->add_flag("--json", options->json, "As JSON");
  command->footer(
      "Work is the positive mechanical work at the output, the integral of max(torque x velocity, "
      "0).\n\n"
      "Examples:\n"
      "  sinew score before.mcap after.mcap --from 2\n"
      "  sinew score run.mcap --json");
  command->callback([options] {
    const std::vector<Scored> list = ScoreAll(*options);
    options->json ? PrintJson(list) : PrintText(list);
  });
}

}  // namespace sinew::tools
