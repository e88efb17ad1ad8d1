// Reads `schema: sinew-regime/1` (docs/participants/regime.md). Throws UsageError.
#pragma once

#include <filesystem>
#include <vector>

#include "components/base/config/fields.h"
#include "components/robot/regime/detector.h"

namespace sinew::regime {

inline constexpr char kSchema[] = "sinew-regime/1";

struct RegimeConfig {
  std::vector<DetectorConfig> joints;
  bool requests_motion() const;  // a joint has setup: active
};

void Describe(config::Fields& fields, RegimeConfig& config);
RegimeConfig LoadRegime(const std::filesystem::path& path);

}  // namespace sinew::regime
