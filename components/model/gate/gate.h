// The data gate: checks of recordings before a fit.
//
// Faults stop: a reversed drive, wrong units, many spikes, frozen or wrapped channels, a missing
// constant. Each names its rule (rules.h), channel, recording and rows, and what to do. Findings do
// not stop: stamps, lost rows, saturation, resolution, lags between channels, a few spikes, whose
// rows are left out. Nothing else is mended or aligned. Pure; allocates; reads no clock. Thread:
// any.
#pragma once

#include <Eigen/Core>
#include <set>
#include <string>
#include <vector>

#include "components/base/types/run.h"
#include "components/model/actuator/model.h"

namespace sinew::gate {

// Measurement by a rule on a channel of a recording, or on all of them.
struct Measurement {
  std::string rule{};
  std::string signal{};                       // "motor_current"; empty: none in particular
  std::string recording{};                    // empty: all of them, or the model
  Eigen::Index first_row = 0, last_row = -1;  // last < first: no rows
  double from_s = 0.0, to_s = 0.0;
  double statistic = 0.0;
  double limit = 0.0;
  std::string reason{};  // a sentence
  std::string remedy{};  // a sentence
};

// A property of a recording that does not stop the analysis: reported, never silently corrected.
struct Finding {
  std::string name;  // stable, e.g. "lost_rows"
  std::string text;  // one sentence
  double value = 0.0;
  std::string unit;
};

struct Fault : Measurement {
  bool accepted = false;
};

// More spikes of a channel in one recording are a fault. A handful: a bus or a converter garbles a
// row now and then, and a fit does without it; a channel that does so more often has a bad contact
// or is no such signal, and its smaller spikes, below the limit, stay in the recording.
inline constexpr std::size_t kMostLeftOut = 5;

// Name of the finding that names them.
inline constexpr const char* kLeftOutRows = "left_out_rows";

// Rows of a recording in which a channel stands alone: every later check and fit does without them.
struct LeftOut {
  std::size_t run = 0;  // its place among the recordings that were examined
  std::string signal;
  std::vector<Eigen::Index> rows;  // rising
};

struct GateOptions {
  // Rules whose faults do not stop; where `spike` is accepted, no row is left out.
  std::set<std::string> accepted;
};

struct GateReport {
  std::vector<Fault> faults;  // in the order of the rules
  std::vector<Finding> findings;
  std::vector<LeftOut> left_out;  // each with a finding, none with a fault
  // The largest statistic of every rule that could be computed, below its limit or not.
  std::vector<Measurement> largest;

  bool stops() const;  // a fault that was not accepted
};

// Throws std::invalid_argument for an accepted fault that is no rule, and for runs whose channels
// differ in length from their stamps. model: of any joint; a model with rigid bodies (an arm) is
// not asked about sign and units of its drive.
GateReport ExamineData(const std::vector<types::Run>& runs, const actuator::JointModel& model,
                       const GateOptions& options = {});

// The recordings without the rows of `left_out`; everything else about them, their content hashes
// too, stays. runs: those that were examined, in their order. Throws std::out_of_range for others.
std::vector<types::Run> WithoutRows(std::vector<types::Run> runs,
                                    const std::vector<LeftOut>& left_out);

// "--accept-fault spike": what continues in spite of the fault.
std::string AcceptOption(const Fault& fault);

// "spike: motor_current of train_1.csv, rows 10 to 10 (0.12 s): ... Remedy. To continue in spite of
// it: --accept-fault spike."
std::string FormatFault(const Fault& fault);

}  // namespace sinew::gate
