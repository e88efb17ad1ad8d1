#include "sim/world/file/world_file.h"

#include <algorithm>
#include <stdexcept>

#include "components/base/types/joined.h"
#include "components/bodies/links/file/urdf_file.h"
#include "components/model/actuator/file/model_file.h"
#include "components/model/payloads/payloads.h"

namespace sinew::world {

using config::kNotNegative;
using config::kPositive;

static void Describe(config::Fields& f, plant::PneumaticConfig& c) {
  f("chamber_volume_m3", c.chamber_volume_m3, kPositive, "at the rest angle");
  f("reservoir_volume_m3", c.reservoir_volume_m3, kNotNegative,
    "0: the valve leads to a source of constant pressure");
  f("source_pressure_bar", c.source_pressure_bar, kNotNegative,
    "reservoir at the start, or the source; gauge");
  f("initial_pressure_bar", c.initial_pressure_bar, kNotNegative, "of the chamber");
  f("valve_conductance_m3_s", c.valve_conductance_m3_s, kNotNegative, "open");
  f("leak_conductance_m3_s", c.leak_conductance_m3_s, kNotNegative, "of the chamber");
  f("vent_conductance_m3_s", c.vent_conductance_m3_s, kNotNegative, "of the reservoir, open");
  f("compressor_flow_bar_m3_s", c.compressor_flow_bar_m3_s, kNotNegative, "on");
  f("compressor_cut_out_bar", c.compressor_cut_out_bar, kNotNegative, "delivers nothing above it");
}

// The keys of a joint beside its name.
static void Describe(config::Fields& f, WorldJointConfig& c) {
  plant::JointPlantConfig& plant = c.plant;
  plant.motor_temperature_degC = 25.0;
  f("~position_rad", c.position_rad, "at the start, at rest");
  f("declared_payload_kg", c.declared_payload_kg, kNotNegative, "what the operator declares");
  f("motor_temperature_degC", plant.motor_temperature_degC, {-40.0, 200.0}, "constant");
  f("motor_encoder_counts", c.motor_encoder_counts, kNotNegative, "per motor turn; 0: exact");
  f("output_encoder_counts", c.output_encoder_counts, kNotNegative, "per turn; 0: exact");
  f.Object("controller", "of the drive", [&](config::Fields& g) {
    g("position_gain_1_s", plant.position_gain_1_s, {0.1, 1000.0}, "speed per error");
    g("velocity_bandwidth_rad_s", plant.velocity_bandwidth_rad_s, {0.1, 3000.0}, "of the speed");
    g("velocity_integral_1_s", plant.velocity_integral_1_s, {0.0, 1000.0}, "of its integral part");
  });
  f.Object("teeth", "where the joint has free play", [&](config::Fields& g) {
    g("stiffness_Nm_rad", plant.contact_stiffness_Nm_rad, kPositive, "at the output");
    g("damping_ratio", plant.contact_damping_ratio, {0.0, 2.0}, "of their contact");
  });
  c.has_pneumatics = f.If("pneumatics", "a chamber with its air supply",
                          [&](config::Fields& g) { Describe(g, c.pneumatics); });
}

static void Describe(config::Fields& f, GroundConfig& c) {
  f("height_m", c.height_m, "of its surface");
  f("friction", c.friction, kNotNegative, "mu");
  f("static_load_N", c.static_load_N, kPositive, "of one contact, robot standing");
  f("static_sink_m", c.static_sink_m, kPositive, "depth under that load");
  f("restitution", c.restitution, "at the impact speed; between 0 and 1");
  f("impact_speed_m_s", c.impact_speed_m_s, kPositive, "where restitution counts");
  f("tangential_damping_ratio", c.tangential_damping_ratio, kNotNegative, "zeta");
  f.Require(c.restitution > 0.0 && c.restitution < 1.0, "restitution",
            "expected above 0 and below 1");
}

// Keys by unit: "_m_s2", "_rad_s", "_N".
static void Describe(config::Fields& f, SensorErrors& c, const std::string& unit) {
  f("bandwidth_Hz", c.bandwidth_Hz, kNotNegative, "of the low pass; 0: none");
  f("noise_density" + unit + "_sqrtHz", c.noise_density, kNotNegative, "needs a bandwidth");
  f("bias" + unit, c.bias, kNotNegative, "largest");
  f("scale_error", c.scale_error, kNotNegative, "largest, below 1");
  f("step" + unit, c.step, kNotNegative, "of the converter; 0: none");
  f("range" + unit, c.range, kNotNegative, "largest reading; 0: none");
}

static void Describe(config::Fields& f, ImuErrors& c) {
  bool part = false;
  f.Word("part", part, {{"none", false}, {"mpu6050", true}}, "where the values below begin");
  if (part) c = kMpu6050;
  f.Object("force", "specific force", [&](config::Fields& g) { Describe(g, c.force, "_m_s2"); });
  f.Object("rate", "angular velocity", [&](config::Fields& g) { Describe(g, c.rate, "_rad_s"); });
}

static void Describe(config::Fields& f, SensorNoise& c) {
  f("seed", c.seed, kNotNegative, "of the noise");
  f("motor_current_A", c.motor_current_A, kNotNegative, "of every reading");
  f("foot_force_N", c.foot_force_N, kNotNegative, "of each sensor");
  // Beyond this a turn is no small one.
  f("orientation_rad", c.orientation_rad, {0.0, 0.1}, "about each axis");
  f("angular_velocity_rad_s", c.angular_velocity_rad_s, kNotNegative, "per axis");
  f("acceleration_m_s2", c.acceleration_m_s2, kNotNegative, "per axis");
}

static void Describe(config::Fields& f, FloatingBase& c) {
  std::vector<std::string> links;
  f("contacts", links,
    "links; the first eight contacts are the force sensors of the feet, right 0-3, left 4-7 "
    "(idl/sensors.idl), further ones have no sensor");
  for (const std::string& link : links) c.contacts.push_back({.link = link});
  f.List("contact_points", {}, "the same for a URDF without such links; they follow the contacts",
         [&](config::Fields& g) {
           ContactFrame& contact = c.contacts.emplace_back();
           std::array<double, 3> point_m{};
           g.Need("link", contact.link, "of the URDF");
           g.Need("point_m", point_m, "in the link's frame");
           contact.point_m = {point_m[0], point_m[1], point_m[2]};
         });
  f("ground", c.ground, "sim/world/contact.h");
  f("imu", c.imu_link, "link fixed to the base; no IMU when left out");
  f("base_height_m", c.base_height_m,
    "of the base link's origin; left out: the contacts carry the weight");
  f.Word("start", c.start, {{"upright", StartPose::kUpright}, {"at_rest", StartPose::kAtRest}},
         "passive joints at 0, or so that contacts and springs carry the weight "
         "(sim/world/rest_pose.h)");
  f("imu_errors", c.imu_errors, "sim/world/sensor_errors.h; left out: an ideal IMU");
  f.Object("foot_errors", "the same of the feet",
           [&](config::Fields& g) { Describe(g, c.foot_errors, "_N"); });
  f("noise", c.noise, "standard deviations of white noise; left out: 0");
}

static void DescribeJoints(config::Fields& f, WorldConfig* c) {
  const auto& models = c->model.joints;
  c->joints.resize(models.size());
  std::vector<std::string> seen;
  f.List("joints", {}, "by name; joints left out start at 0", [&](config::Fields& g) {
    std::string name;
    WorldJointConfig joint;
    g.Need("name", name, "of the model");
    const auto found = std::find_if(models.begin(), models.end(),
                                    [&](const auto& model) { return model.name == name; });
    if (g.reads() && found == models.end()) {
      std::vector<std::string> known;
      known.reserve(models.size());
      for (const auto& model : models) known.push_back(model.name);
      g.Fail("name", "'" + name + "', expected a joint of the model: " + types::Joined(known));
    }
    if (std::count(seen.begin(), seen.end(), name) > 0) {
      g.Fail("name", "'" + name + "' is given twice");
    }
    seen.push_back(name);
    g.set_linear(g.reads() && found->kind == types::JointKind::kPrismatic);
    Describe(g, joint);
    if (g.reads()) c->joints[static_cast<std::size_t>(found - models.begin())] = joint;
  });
}

void Describe(config::Fields& f, WorldFile& file, const std::filesystem::path& model_path,
              const std::filesystem::path& urdf_path) {
  std::filesystem::path model;
  WorldConfig& c = file.config;
  f.PathOr("model", model, model_path,
           "any model file, also one that close-loop wrote, or a rig.json", model_path.empty());
  f.PathOr("urdf", file.urdf, urdf_path, "of the robot", urdf_path.empty());
  if (f.reads()) {
    c.model = actuator::LoadRobotModel(model);
    try {
      c.chain = arm::WithPayloads(arm::ParseUrdf(config::ReadFile(file.urdf), file.urdf.string()),
                                  c.model.payloads);
    } catch (const std::invalid_argument& error) {
      throw UsageError(model.string() + ": " + error.what());
    }
  }
  f("floating_base", file.floating_base, "of a robot that stands on the ground");
  const auto loose = std::find_if(c.model.joints.begin(), c.model.joints.end(),
                                  [](const auto& joint) { return joint.backlash_rad > 0.0; });
  const bool has_play = loose != c.model.joints.end();
  if (file.floating_base && f.reads() && !has_play) c.substep_s = kRobotSubstep_s;
  f("substep_s", c.substep_s, {1e-6, 1e-2},
    "at most 1e-4 where a joint has free play; 2.5e-4 on a floating base without any");
  DescribeJoints(f, &c);
  f.Others({"guard"});
  if (has_play && c.substep_s > 1e-4) {
    f.Fail("substep_s", "joint '" + loose->name + "' has free play, expected at most 1e-4");
  }
}

WorldFile LoadWorldFile(const std::filesystem::path& path, const std::filesystem::path& model_path,
                        const std::filesystem::path& urdf_path) {
  const config::Section root = config::Section::Load(path, kSchema);
  auto file = config::Read<WorldFile>(root, model_path, urdf_path);
  file.guard = root.ChildOrEmpty("guard");
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
