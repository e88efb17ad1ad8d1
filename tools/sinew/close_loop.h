// `sinew close-loop`: which effect a model lacks, from recordings.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "components/model/actuator/file/model_file.h"
#include "components/model/report/report.h"

namespace CLI {
class App;
}

namespace sinew::tools {

struct CloseLoopOptions {
  std::filesystem::path model;         // empty: robots/rig/model.yaml
  std::filesystem::path map;           // empty: csv_map.yaml beside the model, else the rig's
  std::filesystem::path held_out_map;  // of the held-out CSV files; empty: `map`
  std::vector<std::filesystem::path> train;
  std::vector<std::filesystem::path> held_out;  // empty: each of `train` is held out once
  std::filesystem::path out;                    // folder; empty: nothing is written
  int joint = 0;
  int searches = 1;  // joints that are traced together (trace::TraceOptions)
  std::function<double(const actuator::JointModel&)> held_out_error;  // the same
  std::vector<trace::Fold> folds;  // of an arm's joint without held-out recordings
  std::filesystem::path urdf;      // of an arm; empty: what the model file names
  std::uint64_t seed = 1;
  bool by_simulation = false;  // fits and search (shooting::CloseBySimulation) of one joint alone
  bool keep_unconfirmed = false;  // in the model, effects that are neither confirmed nor refuted
  std::optional<std::set<std::string>> given;  // these effects, nothing is searched for
  std::vector<std::string> accepted_faults;    // rules of the data gate that do not stop
  // What the data gate found on these recordings, which lack the rows that it left out already;
  // empty: they are examined.
  std::optional<gate::GateReport> gate;
  std::function<void(const std::string&, double)> progress;
};

struct CloseLoopResult {
  report::Report report;
  gate::GateReport gate;      // where it stops nothing was traced and the model is as it was
  actuator::ModelFile model;  // corrected, as written
  std::string html, json;

  // False: the data stopped it (data_fault, too_little_data), and there is no corrected model.
  bool assessed() const { return !gate.stops() && !report.trace.too_little; }
};

// Reads, traces, draws; then writes report.html, report.json and, when a fit was made,
// model.yaml into the folder, each as a whole, after everything has succeeded. Throws UsageError
// (one line) for anything a user can mend.
CloseLoopResult RunCloseLoop(const CloseLoopOptions& options);

// Model and mappings that the options name, the shipped ones where they name none.
struct LoopInput {
  actuator::ModelFile model;
  std::filesystem::path model_path, map, held_out_map;
};
LoopInput LoadLoopInput(const CloseLoopOptions& options);

// Recordings of one joint, FILE or FILE@START:END; mcap files need no mapping. Throws UsageError,
// also for a recording without an angle.
std::vector<types::Run> ReadJoint(const std::vector<std::filesystem::path>& files,
                                  const std::filesystem::path& map, int joint);

// Throws UsageError naming both when ranges of one file share rows.
void RequireOtherRows(const std::vector<std::filesystem::path>& train,
                      const std::vector<std::filesystem::path>& held_out);

// The joint `options.joint` on recordings that are read already; nothing is written.
CloseLoopResult CloseLoopOn(const CloseLoopOptions& options, const LoopInput& input,
                            std::vector<types::Run> train, std::vector<types::Run> held_out);

std::vector<report::Recording> Describe(const std::vector<types::Run>& runs);

// The data gate with the options' accepted faults. Throws std::invalid_argument.
gate::GateReport AskGate(const CloseLoopOptions& options, const std::vector<types::Run>& runs,
                         const actuator::JointModel& joint);

// Takes out the rows that the gate left out of the recordings, train in front of held_out.
void LeaveOutRows(const std::vector<gate::LeftOut>& left_out, std::vector<types::Run>* train,
                  std::vector<types::Run>* held_out);

// Can these recordings be held out in turn? Throws UsageError.
void RequireRotation(const CloseLoopOptions& options, const std::vector<types::Run>& runs);

// What --without-rule takes.
std::vector<std::string> RuleNames();

// What --accept-fault takes.
std::vector<std::string> FaultNames();

// Throws UsageError.
void MakeFolder(const std::filesystem::path& folder);

// Faults, and rows that were left out.
void PrintGate(const gate::GateReport& gate);

void PrintSummary(const CloseLoopResult& result, const CloseLoopOptions& options);

void AddCloseLoopCommand(CLI::App& app);

}  // namespace sinew::tools
