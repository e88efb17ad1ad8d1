// Configuration of the participant sinew-esn, schema sinew-esn-participant/1 (docs/formats_esn.md).
#pragma once

#include <filesystem>
#include <optional>

#include "components/base/config/fields.h"
#include "components/learn/esn/inverse_dynamics.h"
#include "components/learn/esn/weights.h"

namespace sinew::esn {

inline constexpr char kEsnSchema[] = "sinew-esn-participant/1";

struct EsnConfig {
  enum class Mode { kNetwork, kInverseDynamics };
  Mode mode = Mode::kNetwork;
  // kNetwork: at least one.
  std::optional<Weights> sea;
  std::optional<Weights> pea;
  bool adaptation = false;                 // readouts are awaited from sinew-rls
  InverseDynamicsConfig inverse_dynamics;  // kInverseDynamics
};

// Weights given on the command line, in place of those in the file. Empty: as the file says.
struct WeightsPaths {
  std::filesystem::path sea;
  std::filesystem::path pea;
};

// The weights that a key names, or those given instead; nothing: neither. Throws UsageError.
std::optional<Weights> DescribeWeights(config::Fields& fields, const char* key,
                                       const std::filesystem::path& given);

// Keys `stance` (none, double) and `urdf`; the bodies carry the robot's payloads. Throws
// UsageError.
std::optional<StanceConfig> DescribeStance(config::Fields& fields,
                                           const actuator::RobotModel& robot);

void Describe(config::Fields& fields, EsnConfig& config, const WeightsPaths& given = {},
              const std::filesystem::path& model = {});

// path may be empty when weights are given. model: of inverse dynamics, in place of the one that
// the file names; empty: that one. Throws UsageError: file, line, key, expected.
EsnConfig LoadEsnConfig(const std::filesystem::path& path, const WeightsPaths& given = {},
                        const std::filesystem::path& model = {});

}  // namespace sinew::esn
