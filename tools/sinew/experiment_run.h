// One experiment of the rig as `sinew experiment` runs it: over topics or from a recording; and the
// interface through which a simulation in this process takes the robot's place.
#pragma once

#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "components/model/actuator/model.h"
#include "components/model/experiment/protocol.h"
#include "components/model/experiment/result.h"
#include "components/model/report/section.h"
#include "components/topics/node/options.h"

namespace CLI {
class App;
}

namespace sinew::tools {

struct ExperimentOptions {
  std::vector<std::string> names;
  std::filesystem::path model, update_model, out, recording, map, record;
  int joint = 0;
  int trials = 0;  // 0: the experiment's own number
  double from_s = 0.0;
  double rest_s = 40.0;
  std::uint64_t seed = 1;
  bool quick = false;
  bool json = false;
  bool topics = false;
  bool arm = false;
  node::Options node;

  // Neither topics nor a recording: a simulation in this process.
  bool in_process() const { return !topics && recording.empty(); }
};

// Additions of a simulation to the result.
struct ExperimentAddition {
  std::vector<std::string> lines;  // of the printed result
  nlohmann::ordered_json json;     // keys of result.json; null: none
  std::vector<report::Comparison> comparisons;
  std::vector<report::Table> tables;
};

struct ExperimentOutcome {
  experiment::Result result;
  experiment::Recording rows;  // to be written as CSV
  std::string source;          // of the data, for the model's history
  std::string ending;          // over topics: why it ended
  ExperimentAddition addition;
  std::vector<std::string> changes;  // of the model
  double simulated_s = 0.0;
  double seconds = 0.0;
};

// A rig that is simulated in this process.
class SimulatedRig {
 public:
  virtual ~SimulatedRig() = default;
  // Throws std::invalid_argument: no such experiment, or a recording that is too short.
  virtual ExperimentOutcome Run(const std::string& name,
                                const experiment::RigConstants& constants) const = 0;
  // Writes the true values of this rig into a result, however it was recorded.
  virtual void FillTruth(experiment::Result* result) const = 0;
};

// Makes simulated rigs for the command `experiment`; it lives as long as the program's options.
class ExperimentSimulation {
 public:
  virtual ~ExperimentSimulation() = default;
  virtual void AddOptions(CLI::App& command) = 0;
  // The rig that the options describe; null when the experiment is not in_process() and the options
  // name no rig. Throws UsageError.
  virtual std::unique_ptr<SimulatedRig> MakeRig(const ExperimentOptions& options) const = 0;
};

// The rig's constants as a model declares them.
experiment::RigConstants ConstantsOf(const actuator::JointModel& model);

// Identifies from options.recording. Throws UsageError, std::invalid_argument.
ExperimentOutcome RunFromRecording(const std::string& name,
                                   const experiment::RigConstants& constants,
                                   const ExperimentOptions& options);

// Runs the protocol on whatever state provider is there, then identifies from what was received, or
// from options.record. Returns when the protocol or `stop` ends it. Throws std::runtime_error.
ExperimentOutcome RunOverTopics(const std::string& name, const actuator::JointModel& model,
                                const experiment::RigConstants& constants, node::StopFlag& stop,
                                const ExperimentOptions& options);

}  // namespace sinew::tools
