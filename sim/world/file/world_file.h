// Configuration of the simulated robot, `schema: sinew-world/1`.
//
//   schema: sinew-world/1
//   urdf: rig.urdf
//   model: model.yaml                  # any model file, also one that close-loop wrote, or a
//   rig.json substep_s: 1.0e-4                  # at most 1e-4 with free play guard:
//   {missed_periods: 3, fault_after_ms: 60, bridging: damp} joints:                            # by
//   name; joints left out start at 0
//     - name: joint
//       position_rad: -1.2             # position_m for a linear joint
//       declared_payload_kg: 0
//       motor_temperature_degC: 25
//       motor_encoder_counts: 16384    # per turn; left out: exact
//       output_encoder_counts: 16384
//       controller: {position_gain_1_s: 30, velocity_bandwidth_rad_s: 300, velocity_integral_1_s:
//       30} teeth: {stiffness_Nm_rad: 2.0e+4, damping_ratio: 0.3} pneumatics:
//         chamber_volume_m3: 1.2e-4
//         reservoir_volume_m3: 2.0e-3  # 0: the valve leads to a source of constant pressure
//         source_pressure_bar: 6       # gauge
//         ...
//
// Throws UsageError (one line: file, line, key, expected), also for the URDF and the model.
#pragma once

#include <filesystem>
#include <memory>

#include "components/config/config.h"
#include "sim/world/world.h"

namespace sinew::world {

struct WorldFile {
  WorldConfig config;
  std::filesystem::path urdf;                          // that was read
  config::Section guard = config::Section::Empty("");  // for provider::LoadGuardConfig
};

// model_path, urdf_path: used instead of the file's own when they are not empty.
WorldFile LoadWorldFile(const std::filesystem::path& path,
                        const std::filesystem::path& model_path = {},
                        const std::filesystem::path& urdf_path = {});

// World(config) with its complaints as UsageError naming the file.
std::unique_ptr<World> MakeWorld(const WorldFile& file, const std::filesystem::path& path);

}  // namespace sinew::world
