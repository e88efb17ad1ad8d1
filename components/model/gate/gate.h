// The data gate: checks of recordings before a fit.
//
// Faults stop: a reversed drive, wrong units, spikes, frozen or wrapped channels, a missing
// constant. Each names its rule (rules.h), channel, recording and rows, and what to do. Findings do
// not stop: stamps, lost rows, saturation, resolution, lags between channels. Nothing is mended or
// aligned. Pure; allocates; reads no clock. Thread: any.
#pragma once

#include <Eigen/Core>
#include <set>
#include <string>
#include <vector>

#include "components/base/types/run.h"
#include "components/model/actuator/model.h"
#include "components/model/identify/finding.h"

namespace sinew::gate {

// What a rule found on a channel of a recording, or on all of them.
struct Measurement {
  std::string rule;
  std::string signal;                         // "motor_current"; empty: none in particular
  std::string recording;                      // empty: all of them, or the model
  Eigen::Index first_row = 0, last_row = -1;  // last < first: no rows
  double from_s = 0.0, to_s = 0.0;
  double statistic = 0.0;
  double limit = 0.0;
  std::string reason;  // a sentence
  std::string remedy;  // a sentence
};

struct Fault : Measurement {
  bool accepted = false;
};

struct GateOptions {
  std::set<std::string> accepted;  // rules whose faults do not stop
};

struct GateReport {
  std::vector<Fault> faults;  // in the order of the rules
  std::vector<identify::Finding> findings;
  // The largest statistic of every rule that could be computed, below its limit or not.
  std::vector<Measurement> largest;

  bool stops() const;  // a fault that was not accepted
};

// Throws std::invalid_argument for an accepted fault that is no rule, and for runs whose channels
// differ in length from their stamps. model: of any joint; a model with rigid bodies (an arm) is
// not asked about sign and units of its drive.
GateReport ExamineData(const std::vector<types::Run>& runs, const actuator::JointModel& model,
                       const GateOptions& options = {});

// "spike: motor_current of train_1.csv, rows 10 to 10 (0.12 s): ... Remedy."
std::string FormatFault(const Fault& fault);

}  // namespace sinew::gate
