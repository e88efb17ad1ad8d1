// Reads `schema: sinew-pneumatics/1` (docs/participants/pneumatics.md). Throws UsageError.
#pragma once

#include <filesystem>
#include <vector>

#include "components/base/config/config.h"
#include "components/robot/pneumatics/manager.h"

namespace sinew::pneumatics {

struct PneumaticsConfig {
  std::vector<ManagerConfig> joints;
  bool hold_disarmed = false;    // holds pressure before the robot is armed, too
  bool motion_requests = false;  // reads motion_request for the pressure it asks for
  double motion_timeout_s = 0.5;
};

PneumaticsConfig LoadPneumatics(const std::filesystem::path& path);
PneumaticsConfig ReadPneumatics(const config::Section& section);

}  // namespace sinew::pneumatics
