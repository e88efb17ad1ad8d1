#include "sim/world/file/world_file.h"

#include <algorithm>
#include <memory>
#include <stdexcept>

#include "components/bodies/links/file/urdf_file.h"
#include "components/model/actuator/file/model_file.h"
#include "components/model/payloads/payloads.h"

namespace sinew::world {

namespace {

using config::Section;

void ReadPneumatics(const Section& section, plant::PneumaticConfig* pneumatics) {
  const auto number = [&](const char* key, double* value) {
    *value = section.NumberOr(key, *value, config::kNotNegative);
  };
  pneumatics->chamber_volume_m3 =
      section.NumberOr("chamber_volume_m3", pneumatics->chamber_volume_m3, config::kPositive);
  number("reservoir_volume_m3", &pneumatics->reservoir_volume_m3);
  number("source_pressure_bar", &pneumatics->source_pressure_bar);
  number("initial_pressure_bar", &pneumatics->initial_pressure_bar);
  number("valve_conductance_m3_s", &pneumatics->valve_conductance_m3_s);
  number("leak_conductance_m3_s", &pneumatics->leak_conductance_m3_s);
  number("vent_conductance_m3_s", &pneumatics->vent_conductance_m3_s);
  number("compressor_flow_bar_m3_s", &pneumatics->compressor_flow_bar_m3_s);
  number("compressor_cut_out_bar", &pneumatics->compressor_cut_out_bar);
}

WorldJointConfig ReadJoint(const Section& section, const actuator::JointModel& model) {
  WorldJointConfig joint;
  const bool rotary = model.kind == types::JointKind::kRotary;
  joint.position_rad = section.NumberOr(rotary ? "position_rad" : "position_m", 0.0);
  joint.declared_payload_kg = section.NumberOr("declared_payload_kg", 0.0, config::kNotNegative);
  joint.plant.motor_temperature_degC =
      section.NumberOr("motor_temperature_degC", 25.0, {-40.0, 200.0});
  joint.motor_encoder_counts = section.NumberOr("motor_encoder_counts", 0.0, config::kNotNegative);
  joint.output_encoder_counts =
      section.NumberOr("output_encoder_counts", 0.0, config::kNotNegative);
  const Section controller = section.ChildOrEmpty("controller");
  plant::JointPlantConfig& plant = joint.plant;
  plant.position_gain_1_s =
      controller.NumberOr("position_gain_1_s", plant.position_gain_1_s, {0.1, 1000.0});
  plant.velocity_bandwidth_rad_s = controller.NumberOr(
      "velocity_bandwidth_rad_s", plant.velocity_bandwidth_rad_s, {0.1, 3000.0});
  plant.velocity_integral_1_s =
      controller.NumberOr("velocity_integral_1_s", plant.velocity_integral_1_s, {0.0, 1000.0});
  const Section teeth = section.ChildOrEmpty("teeth");
  plant.contact_stiffness_Nm_rad =
      teeth.NumberOr("stiffness_Nm_rad", plant.contact_stiffness_Nm_rad, config::kPositive);
  plant.contact_damping_ratio =
      teeth.NumberOr("damping_ratio", plant.contact_damping_ratio, {0.0, 2.0});
  joint.has_pneumatics = section.Has("pneumatics");
  if (joint.has_pneumatics) ReadPneumatics(section.Child("pneumatics"), &joint.pneumatics);
  section.RejectUnknownKeys();
  return joint;
}

GroundConfig ReadGround(const Section& section) {
  GroundConfig ground;
  ground.height_m = section.NumberOr("height_m", ground.height_m);
  ground.friction = section.NumberOr("friction", ground.friction, config::kNotNegative);
  ground.static_load_N = section.NumberOr("static_load_N", ground.static_load_N, config::kPositive);
  ground.static_sink_m = section.NumberOr("static_sink_m", ground.static_sink_m, config::kPositive);
  ground.restitution = section.NumberOr("restitution", ground.restitution);
  ground.impact_speed_m_s =
      section.NumberOr("impact_speed_m_s", ground.impact_speed_m_s, config::kPositive);
  ground.tangential_damping_ratio = section.NumberOr(
      "tangential_damping_ratio", ground.tangential_damping_ratio, config::kNotNegative);
  if (!(ground.restitution > 0.0 && ground.restitution < 1.0)) {
    section.Fail("restitution", "expected above 0 and below 1");
  }
  return ground;
}

// Keys by unit: "_m_s2", "_rad_s", "_N". What is left out stays as in `errors`.
SensorErrors ReadErrors(const Section& section, const std::string& unit, SensorErrors errors) {
  const auto number = [&](const std::string& key, double* value) {
    *value = section.NumberOr(key, *value, config::kNotNegative);
  };
  number("bandwidth_Hz", &errors.bandwidth_Hz);
  number("noise_density" + unit + "_sqrtHz", &errors.noise_density);
  number("bias" + unit, &errors.bias);
  number("scale_error", &errors.scale_error);
  number("step" + unit, &errors.step);
  number("range" + unit, &errors.range);
  section.RejectUnknownKeys();
  return errors;
}

ImuErrors ReadImuErrors(const Section& section) {
  ImuErrors errors;
  if (section.ChoiceOr("part", "none", {"none", "mpu6050"}) == "mpu6050") errors = kMpu6050;
  errors.force = ReadErrors(section.ChildOrEmpty("force"), "_m_s2", errors.force);
  errors.rate = ReadErrors(section.ChildOrEmpty("rate"), "_rad_s", errors.rate);
  section.RejectUnknownKeys();
  return errors;
}

SensorNoise ReadNoise(const Section& section) {
  SensorNoise noise;
  noise.seed = static_cast<std::uint64_t>(section.IntegerOr("seed", 1, config::kNotNegative));
  const auto number = [&](const char* key, double* value) {
    *value = section.NumberOr(key, 0.0, config::kNotNegative);
  };
  number("motor_current_A", &noise.motor_current_A);
  number("foot_force_N", &noise.foot_force_N);
  // Beyond this a turn is no small one.
  noise.orientation_rad = section.NumberOr("orientation_rad", 0.0, {0.0, 0.1});
  number("angular_velocity_rad_s", &noise.angular_velocity_rad_s);
  number("acceleration_m_s2", &noise.acceleration_m_s2);
  section.RejectUnknownKeys();
  return noise;
}

FloatingBase ReadFloatingBase(const Section& section) {
  FloatingBase base;
  for (const std::string& link : section.TextsOr("contacts", {})) {
    base.contacts.push_back({.link = link});
  }
  for (const Section& point : section.ListOrEmpty("contact_points")) {
    const std::vector<double> at = point.Numbers("point_m");
    if (at.size() != 3) point.Fail("point_m", "expected x, y and z");
    base.contacts.push_back({.link = point.Text("link"), .point_m = {at[0], at[1], at[2]}});
  }
  base.ground = ReadGround(section.ChildOrEmpty("ground"));
  base.imu_link = section.TextOr("imu", "");
  if (section.Has("base_height_m")) base.base_height_m = section.Number("base_height_m");
  base.start = section.ChoiceOr("start", "upright", {"upright", "at_rest"}) == "at_rest"
                   ? StartPose::kAtRest
                   : StartPose::kUpright;
  base.imu_errors = ReadImuErrors(section.ChildOrEmpty("imu_errors"));
  base.foot_errors = ReadErrors(section.ChildOrEmpty("foot_errors"), "_N", {});
  base.noise = ReadNoise(section.ChildOrEmpty("noise"));
  section.RejectUnknownKeys();
  return base;
}

}  // namespace

WorldFile LoadWorldFile(const std::filesystem::path& path, const std::filesystem::path& model_path,
                        const std::filesystem::path& urdf_path) {
  const Section root = Section::Load(path, "sinew-world/1");
  WorldFile file;
  const auto chosen = [&](const char* key, const std::filesystem::path& instead) {
    return instead.empty() ? root.ExistingPath(key) : instead;
  };
  const std::filesystem::path model = chosen("model", model_path);
  file.config.model = actuator::LoadRobotModel(model);
  file.urdf = chosen("urdf", urdf_path);
  try {
    file.config.chain =
        arm::WithPayloads(arm::ParseUrdf(config::ReadFile(file.urdf), file.urdf.string()),
                          file.config.model.payloads);
  } catch (const std::invalid_argument& error) {
    throw UsageError(model.string() + ": " + error.what());
  }
  const auto& models = file.config.model.joints;
  const bool has_play = std::any_of(models.begin(), models.end(),
                                    [](const auto& joint) { return joint.backlash_rad > 0.0; });
  if (root.Has("floating_base")) file.floating_base = ReadFloatingBase(root.Child("floating_base"));
  file.config.substep_s = root.NumberOr(
      "substep_s", file.floating_base && !has_play ? kRobotSubstep_s : WorldConfig{}.substep_s,
      {1e-6, 1e-2});
  file.guard = root.ChildOrEmpty("guard");
  file.config.joints.resize(models.size());
  std::vector<bool> seen(models.size());
  for (const Section& section : root.ListOrEmpty("joints")) {
    const std::string name = section.Text("name");
    const auto found = std::find_if(models.begin(), models.end(),
                                    [&](const auto& joint) { return joint.name == name; });
    if (found == models.end()) {
      std::string known;
      for (const auto& joint : models) known += (known.empty() ? "" : ", ") + joint.name;
      section.Fail("name", "'" + name + "', expected a joint of the model: " + known);
    }
    const auto at = static_cast<std::size_t>(found - models.begin());
    if (seen[at]) section.Fail("name", "'" + name + "' is given twice");
    seen[at] = true;
    file.config.joints[at] = ReadJoint(section, *found);
  }
  for (std::size_t j = 0; j < models.size(); ++j) {
    if (models[j].backlash_rad > 0.0 && file.config.substep_s > 1e-4) {
      root.Fail("substep_s", "joint '" + models[j].name + "' has free play, expected at most 1e-4");
    }
  }
  // The guard's keys are asked for by their owner; here only its name is known.
  const std::vector<std::string> known = {"schema", "urdf",   "model",        "substep_s",
                                          "guard",  "joints", "floating_base"};
  for (const std::string& key : root.Keys()) {
    if (std::find(known.begin(), known.end(), key) != known.end()) continue;
    std::string list;
    for (const std::string& name : known) list += (list.empty() ? "" : ", ") + name;
    root.Fail(key, "unknown, expected one of " + list);
  }
  return file;
}

FloatingRobotConfig RobotConfig(const WorldFile& file) {
  const FloatingBase base = file.floating_base.value();
  return {.chain = file.config.chain,
          .model = file.config.model,
          .joints = file.config.joints,
          .contacts = base.contacts,
          .ground = base.ground,
          .imu_link = base.imu_link,
          .base_height_m = base.base_height_m,
          .substep_s = file.config.substep_s,
          .start = base.start,
          .imu_errors = base.imu_errors,
          .foot_errors = base.foot_errors,
          .seed = file.seed,
          .noise = base.noise};
}

std::unique_ptr<provider::SimulatedPlant> MakeWorld(const WorldFile& file,
                                                    const std::filesystem::path& path) {
  try {
    if (file.floating_base) return std::make_unique<FloatingRobot>(RobotConfig(file));
    return std::make_unique<World>(file.config);
  } catch (const std::invalid_argument& error) {
    throw UsageError(path.string() + ": " + error.what());
  }
}

}  // namespace sinew::world
