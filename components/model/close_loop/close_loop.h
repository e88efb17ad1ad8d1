// Finds which effect a model lacks, from recordings: reads them, asks the data gate, fits,
// searches, confirms and reports; for one joint, for the joints of a robot or an arm, or for a
// robot on two feet, as the model file says. Reads files and the clock; one thread.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "components/model/actuator/file/model_file.h"
#include "components/model/arm/arm_loop.h"
#include "components/model/free_run/free_run.h"
#include "components/model/report/report.h"
#include "components/model/report/stance_page.h"

namespace sinew::close_loop {

struct Options {
  std::filesystem::path rig;           // folder of the rig's model.yaml and csv_map.yaml
  std::filesystem::path model;         // empty: the rig's
  std::filesystem::path map;           // empty: csv_map.yaml beside the model, else the rig's
  std::filesystem::path held_out_map;  // of the held-out CSV files; empty: `map`
  std::vector<std::filesystem::path> train;
  std::vector<std::filesystem::path> held_out;  // empty: each of `train` is held out once
  std::optional<int> joint;                     // empty: all joints of the model
  std::filesystem::path urdf;  // of an arm, a robot on two feet; empty: what the model file names
  std::uint64_t seed = 1;
  bool by_simulation = false;  // fits and search (shooting::CloseBySimulation) of one joint alone
  bool keep_unconfirmed = false;  // in the model, effects that are neither confirmed nor refuted
  std::optional<std::set<std::string>> given;  // these effects, nothing is searched for
  trace::InForce in_force;                     // what decides: all, unless something is taken out
  std::vector<std::string> accepted_faults;    // rules of the data gate that do not stop
  free_run::MakeBody body;               // moves a joint in the simulation beside the recordings
  std::function<void(double)> progress;  // share that is done
};

struct Result {
  actuator::ModelFile model;  // corrected; as it was where the data stopped it
  bool assessed = false;      // is there a corrected model?
  report::Page page;
  std::string json;
  // One report each, of the joints that were traced.
  std::vector<report::Report> joints;
  std::optional<arm::ArmLoop> arm;
  std::optional<report::StanceReport> stance;
  // The joints of a robot have pages of their own, in a folder of the joint's name.
  struct Part {
    std::string folder;
    report::Page page;
    std::string json;
  };
  std::vector<Part> parts;
};

// Throws UsageError (one line) for anything a user can mend.
Result CloseLoop(const Options& options);

// Draws the pages and writes report.html, report.json and, when a fit was made, model.yaml, each as
// a whole. made: when, where and by which command, for the end of the pages. Throws UsageError for
// a folder that cannot be made.
void Write(const Result& result, const std::filesystem::path& folder, const std::string& made = "");

}  // namespace sinew::close_loop
