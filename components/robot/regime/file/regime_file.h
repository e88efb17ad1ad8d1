// Reads `schema: sinew-regime/1` (docs/participants/regime.md). Throws UsageError.
#pragma once

#include <filesystem>
#include <vector>

#include "components/base/config/config.h"
#include "components/robot/regime/detector.h"

namespace sinew::regime {

struct RegimeConfig {
  std::vector<DetectorConfig> joints;
  bool requests_motion() const;  // a joint has setup: active
};

RegimeConfig LoadRegime(const std::filesystem::path& path);
RegimeConfig ReadRegime(const config::Section& section);

}  // namespace sinew::regime
