// Reads `schema: sinew-performance/1` (docs/participants/performance.md). Throws UsageError.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "components/base/config/fields.h"
#include "components/robot/performance/centre_height.h"
#include "components/robot/performance/robot_performance.h"

namespace sinew::performance {

inline constexpr char kSchema[] = "sinew-performance/1";

struct PerformanceConfig {
  std::vector<std::string> joint_names;  // of the model, in the order of joint_state
  std::vector<bool> linear;              // m and N in place of rad and N m
  RobotPerformanceConfig robot;
  std::optional<CentreHeight> height;  // empty: no lifting bound
};

void Describe(config::Fields& fields, PerformanceConfig& config);
PerformanceConfig LoadPerformance(const std::filesystem::path& path);

}  // namespace sinew::performance
