// Reads `schema: sinew-pneumatics/1`. Throws UsageError.
#pragma once

#include <filesystem>
#include <vector>

#include "components/base/config/fields.h"
#include "components/robot/pneumatics/manager.h"

namespace sinew::pneumatics {

inline constexpr char kSchema[] = "sinew-pneumatics/1";

struct PneumaticsConfig {
  std::vector<ManagerConfig> joints;
  bool hold_disarmed = false;
  bool motion_requests = false;
  double motion_timeout_s = 0.5;
};

void Describe(config::Fields& fields, PneumaticsConfig& config);
PneumaticsConfig LoadPneumatics(const std::filesystem::path& path);

}  // namespace sinew::pneumatics
