// Reads `schema: sinew-residual/1` (docs/participants/residual.md). Throws UsageError.
#pragma once

#include <filesystem>

#include "components/base/config/fields.h"
#include "components/model/actuator/model.h"
#include "components/robot/residual/monitor.h"

namespace sinew::residual {

inline constexpr char kSchema[] = "sinew-residual/1";

struct ResidualConfig {
  actuator::RobotModel robot;  // a monitor for each of its joints, in the order of joint_state
  MonitorConfig monitor;
};

void Describe(config::Fields& fields, ResidualConfig& config,
              const std::filesystem::path& model_path = {});
// model_path: takes the place of the file's `model`; empty: as the file says.
ResidualConfig LoadResidual(const std::filesystem::path& path,
                            const std::filesystem::path& model_path = {});

}  // namespace sinew::residual
