// Configuration of the participant sinew-rls, schema sinew-rls-participant/1 (docs/formats_esn.md).
#pragma once

#include <filesystem>
#include <optional>

#include "components/learn/esn/file/esn_config.h"
#include "components/learn/esn/weights.h"
#include "components/learn/rls/adapter.h"
#include "components/learn/rls/target.h"
#include "components/model/actuator/model.h"

namespace sinew::rls {

inline constexpr char kSchema[] = "sinew-rls-participant/1";

// Source of the drive torque.
enum class TorqueFrom {
  kMeasured,  // the model's drive terms at the measured current (or voltage)
  kCommand,   // the same at the commanded motor torque: for drives whose current is not measured
};

struct RlsConfig {
  std::optional<esn::Weights> sea;  // the same files as sinew-esn's
  std::optional<esn::Weights> pea;
  actuator::RobotModel robot;
  TorqueFrom torque_from = TorqueFrom::kMeasured;
  TargetConfig target;
  AdapterConfig adapter;
};

void Describe(config::Fields& fields, RlsConfig& config, const esn::WeightsPaths& given = {});
// Throws UsageError: file, line, key, expected.
RlsConfig LoadRlsConfig(const std::filesystem::path& path, const esn::WeightsPaths& given = {});

}  // namespace sinew::rls
