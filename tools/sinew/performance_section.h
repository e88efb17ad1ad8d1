// The performance of a recorded session as a section of a page and as JSON.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "components/base/types/joints.h"
#include "components/model/report/section.h"
#include "components/robot/performance/file/performance_file.h"
#include "components/robot/performance/settle_time.h"

namespace sinew::tools {

struct MeasuredSession {
  std::string name;  // of the recording
  performance::PerformanceConfig config;
  performance::RobotPerformanceOutput output;      // at the end
  std::vector<performance::SettleResult> settle;   // of each joint; empty: no event
  std::vector<double> time_s;                      // since the session's first tick
  std::vector<types::JointArray<double>> rms_rad;  // sliding, as time_s; not a number: not known
};

// A table of joints and robot, the lifting bound, and the sliding RMSE over time of the joints with
// the largest ones.
report::Section MakePerformanceSection(const MeasuredSession& session, const std::string& id);
nlohmann::ordered_json PerformanceJson(const MeasuredSession& session);
// A header line, then a row a tick; a cell is empty where the RMSE is not known.
std::string PerformanceCsv(const MeasuredSession& session);

}  // namespace sinew::tools
