// Model files: YAML with `schema: sinew-model/1`, and a laboratory's rig.json read as the same
// model.
//
//   schema: sinew-model/1
//   name: rig
//   urdf: rig.urdf                       # optional, relative to this file
//   joints:
//     - name: joint
//       kind: rotary                     # or linear
//       constants: {gear_ratio: 100, link_length_m: 0.3, gravity_m_s2: 9.81, torque_constant_Nm_A:
//       0.0159155} backlash_rad: 0.0464258          # optional, full width at the output
//       motor_torque_limit_Nm: 0.398     # optional
//       terms:
//         - effect: drive_current
//           efficiency: {value: 0.77, tolerance: 0.15}
//         - effect: coulomb
//           coulomb_Nm: 0.22             # short for {value: 0.22}
//         - effect: viscous              # an absolute tolerance, in the key's unit
//           viscous_Nm_s_rad: {value: 0, tolerance: {absolute: 0.05}}
//         - effect: stribeck             # added by close-loop
//           declared: false
//           stribeck_Nm: {value: 0.1, half_width_95: 0.02}
//           stribeck_velocity_rad_s: {value: 0.05, fixed: true}
//       history:
//         - {when: "2026-01-01T00:00:00Z", effect: stribeck, recording: train_1.csv, note: "..."}
//   payloads:                            # optional: point masses that the URDF lacks
//     - link: torso                      # of the URDF
//       mass_kg: 4                       # or {value: 3.95, half_width_95: 0.25}
//       position_m: [0.03, 0.02, 0.07]   # in the link's frame
//       declared: false                  # added by close-loop
//       position_half_width_95_m: [0.009, 0.009, 0.3]
//   floating_base:                       # optional: the robot stands on two feet
//     foot_force: [right_force_rear_outer, ...]   # eight links, in the order of the topic
//     imu: imu                           # link
//     mass_tolerance: 0.01               # of links that move as one: share; standard deviations
//     com_tolerance_m: 0.001             # of their centre of mass
//     tilt_tolerance_rad: 0.001          # of the IMU against the base
//   processing: {...}                    # owned by identify, kept as they are
//   as_published: {...}
//   data_gate: {...}
//
// A parameter's key is its name and unit suffix (effects::UnitSuffix). Every parameter of an effect
// must be there. Throws UsageError (one line: file, line, key, expected).
#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "components/base/config/config.h"
#include "components/model/actuator/model.h"

namespace sinew::actuator {

// Keys of a model file that belong to others.
inline constexpr std::string_view kForeignBlocks[] = {"processing", "as_published", "data_gate"};

struct ModelFile {
  RobotModel robot;
  // The whole file; ask it for Child("processing") and so on, and reject unknown keys there.
  config::Section root = config::Section::Empty("");
  // The foreign blocks as YAML text, by key, so that they survive saving.
  std::map<std::string, std::string> foreign_text;
};

// A .json path is read with LoadRigJson, everything else as YAML.
ModelFile LoadModelFile(const std::filesystem::path& path);
RobotModel LoadRobotModel(const std::filesystem::path& path);

// A laboratory's declaration (constants, nominal parameters, the balance of the SEA-PEA rig) as a
// model. Parameters whose trust is not "exact" ("about 5-15 % off") get a tolerance of 10 %.
RobotModel LoadRigJson(const std::filesystem::path& path);

// The text of a model file. `folder`: where it will be, for the relative path of the URDF.
std::string FormatModel(const RobotModel& robot,
                        const std::map<std::string, std::string>& foreign_text,
                        const std::filesystem::path& folder);
// Written as a whole or not at all.
void SaveModelFile(const std::filesystem::path& path, const ModelFile& file);
void SaveRobotModel(const std::filesystem::path& path, const RobotModel& robot);

}  // namespace sinew::actuator
