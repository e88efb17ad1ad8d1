// Configuration of the simulated robot, `schema: sinew-world/1`.
//
// With the section `floating_base` the robot stands on the ground
// (FloatingRobot), without it the base is fixed (World). Without `substep_s`: kRobotSubstep_s on a
// floating base whose joints have no free play, else 1e-4.
//
// The chain has the model file's payloads.
//
// Throws UsageError (one line: file, line, key, expected), also for the URDF and the model.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "components/base/config/fields.h"
#include "components/robot/provider/simulated_plant.h"
#include "sim/world/floating_robot.h"
#include "sim/world/world.h"

namespace sinew::world {

inline constexpr char kSchema[] = "sinew-world/1";

// Members of FloatingRobotConfig that WorldConfig lacks.
struct FloatingBase {
  std::vector<ContactFrame> contacts;
  GroundConfig ground;
  std::string imu_link;
  std::optional<double> base_height_m;
  StartPose start = StartPose::kUpright;
  ImuErrors imu_errors;
  SensorErrors foot_errors;
  SensorNoise noise;
};

struct WorldFile {
  std::uint64_t seed = 1;  // of the sensors' errors: the session's, not the file's
  WorldConfig config;
  std::optional<FloatingBase> floating_base;           // absent: the base is fixed
  std::filesystem::path urdf;                          // that was read
  config::Section guard = config::Section::Empty("");  // for provider::LoadGuardConfig
};

void Describe(config::Fields& fields, WorldFile& file, const std::filesystem::path& model_path = {},
              const std::filesystem::path& urdf_path = {});
// model_path, urdf_path: used instead of the file's own when they are not empty.
WorldFile LoadWorldFile(const std::filesystem::path& path,
                        const std::filesystem::path& model_path = {},
                        const std::filesystem::path& urdf_path = {});

// The configuration of a file with a floating base.
FloatingRobotConfig RobotConfig(const WorldFile& file);

// World or FloatingRobot of the file, with its complaints as UsageError naming the file.
std::unique_ptr<provider::SimulatedPlant> MakeWorld(const WorldFile& file,
                                                    const std::filesystem::path& path);

}  // namespace sinew::world
