// `sinew close-loop` on a robot of several joints: each joint's residual over the catalogue, and
// for an arm (joints with a term `rigid_body`) its rigid bodies first, all joints together.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "components/model/arm/arm_loop.h"
#include "tools/sinew/close_loop.h"

namespace sinew::tools {

struct CloseRobotResult {
  std::vector<int> joint_numbers;       // that were traced
  std::vector<CloseLoopResult> joints;  // one report each
  std::optional<arm::ArmLoop> arm;
  actuator::ModelFile model;  // corrected, as written
  std::string json;           // all joints and the arm
};

// joints: those to trace; empty: all. An arm is fitted with all its joints either way. Writes
// DIR/report.json and DIR/model.yaml, and report.html and report.json of each joint into
// DIR/JOINT. Throws UsageError.
CloseRobotResult CloseRobot(const CloseLoopOptions& options, std::vector<int> joints = {});

void PrintSummary(const CloseRobotResult& result, const CloseLoopOptions& options);

}  // namespace sinew::tools
