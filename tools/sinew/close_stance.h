// `sinew close-loop` on a robot that stands on two feet: its model file has `floating_base`. All
// joints share one balance (components/model/stance_fit), and payloads compete with friction.
#pragma once

#include <string>

#include "components/model/report/stance_page.h"
#include "tools/sinew/close_loop.h"

namespace sinew::tools {

struct CloseStanceResult {
  report::StanceReport report;
  actuator::ModelFile model;  // corrected, as written
  std::string html, json;

  // False: too little data, and there is no corrected model.
  bool assessed() const { return report.result.too_little.empty(); }
};

// Is the model file's robot one of these?
bool StandsOnTwoFeet(const actuator::RobotModel& robot);

// Writes report.html, report.json and, when something was fitted, model.yaml into options.out
// (empty: nothing is written). Throws UsageError, also for options that mean nothing here: map,
// joint, given effects, accepted faults; and for recordings without foot_force or imu.
CloseStanceResult RunCloseStance(const CloseLoopOptions& options, bool one_joint = false);

void PrintSummary(const CloseStanceResult& result, const CloseLoopOptions& options);

}  // namespace sinew::tools
