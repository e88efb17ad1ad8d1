#include "components/robot/provider/participant/provider_options.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "components/base/config/fields.h"
#include "components/bodies/leg/geometry.h"
#include "components/bodies/links/file/urdf_file.h"
#include "components/robot/provider/fall_guard.h"
#include "components/topics/node/time_option.h"

namespace sinew::provider {

namespace {

const arm::Body& BodyOf(const arm::Chain& chain, int index) {
  return chain.bodies[static_cast<std::size_t>(index)];
}

std::vector<std::string> DrivenJoints(const arm::Chain& chain) {
  std::vector<std::string> names;
  for (const arm::Body& body : chain.bodies) {
    if (arm::IsDriven(body)) names.push_back(body.joint_name);
  }
  return names;
}

GuardedLeg ReadLeg(const config::Section& fall, const arm::Chain& chain,
                   const std::vector<std::string>& driven, const std::string& side) {
  const leg::LegJointNames names = leg::NamesOfSide(side);
  GuardedLeg guarded;
  try {
    guarded.geometry = leg::GeometryOf(chain, names, side + "_sole");
  } catch (const std::invalid_argument& error) {
    fall.Fail("urdf", error.what());
  }
  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto found = std::find(driven.begin(), driven.end(), names[i]);
    if (found == driven.end()) {
      fall.Fail("urdf", "joint '" + names[i] + "' has no effort above 0: it is not driven");
    }
    guarded.joint[i] = static_cast<int>(found - driven.begin());
  }
  return guarded;
}

Eigen::Matrix3d ReadImuMounting(const config::Section& fall, const arm::Chain& chain) {
  const auto found = std::find_if(chain.bodies.begin(), chain.bodies.end(),
                                  [](const arm::Body& body) { return body.link_name == "imu"; });
  if (found == chain.bodies.end()) fall.Fail("urdf", "has no link 'imu'");
  Eigen::Matrix3d base_from_imu = Eigen::Matrix3d::Identity();
  for (auto body = static_cast<int>(found - chain.bodies.begin()); body >= 0;
       body = BodyOf(chain, body).parent) {
    if (BodyOf(chain, body).moves) fall.Fail("urdf", "link 'imu' is not fixed to the base");
    base_from_imu = BodyOf(chain, body).parent_from_joint.linear() * base_from_imu;
  }
  return base_from_imu.transpose();
}

void Describe(config::Fields& f, fall::ImuBounds& c) {
  using config::kNotNegative;
  f("force_range_m_s2", c.force_range_m_s2, kNotNegative, "largest reading");
  f("force_bias_m_s2", c.force_bias_m_s2, kNotNegative, "horizontal part");
  f("force_noise_m_s2", c.force_noise_m_s2, kNotNegative, "standard deviation per axis");
  f("rate_range_rad_s", c.rate_range_rad_s, kNotNegative, "largest reading");
  f("rate_bias_rad_s", c.rate_bias_rad_s, kNotNegative, "when switched on");
  f("rate_drift_rad_s2", c.rate_drift_rad_s2, kNotNegative, "of the bias");
  f("rate_noise_rad_s", c.rate_noise_rad_s, kNotNegative, "standard deviation per axis");
  f("rate_scale_error", c.rate_scale_error, kNotNegative, "share of the reading");
}

// The section `fall` of a `guard:` block: a robot on two legs is watched for falls.
//
// The URDF gives the legs (components/bodies/leg/geometry.h; joints left_hip_yaw and so on, links
// left_sole, right_sole), the mass, and the mounting of the link imu, which is fixed to the base.
// The robot's joints, as the topics number them, are the URDF's driven ones in its order: those
// that move and whose effort is above 0.
void Describe(config::Fields& f, FallGuardConfig& c) {
  std::filesystem::path urdf;
  fall::FallConfig& detector = c.detector;
  f.Need("urdf", urdf,
         "legs, mass, mounting of the link imu; joints: its driven ones, in its order");
  f("start_within_s", c.start_within_s, config::kPositive,
    "an armed robot whose detector has not started by then has a fault");
  f("pendulum_length_m", detector.tilt.pendulum_length_m, config::kPositive,
    "foot to highest mass");
  f.Object("imu", "bounds of the robot's part (components/robot/fall/imu_check.h)",
           [&](config::Fields& imu) { Describe(imu, detector.tilt.imu); });
  if (!f.reads()) return;
  const arm::Chain chain = arm::ParseUrdf(config::ReadFile(urdf), urdf.string());
  const std::vector<std::string> driven = DrivenJoints(chain);
  c.joint_count = static_cast<int>(driven.size());
  c.right = ReadLeg(f.section(), chain, driven, "right");
  c.left = ReadLeg(f.section(), chain, driven, "left");
  c.imu_from_base = ReadImuMounting(f.section(), chain);
  detector.mass_kg = chain.base.mass_kg;
  for (const arm::Body& body : chain.bodies) detector.mass_kg += body.mass_kg;
}

}  // namespace

void AddProviderOptions(CLI::App& app, ProviderOptions* options) {
  app.add_option("--rate", options->rate_Hz, "Cycles per second")
      ->check(CLI::Range(1.0, 2000.0))
      ->capture_default_str();
  app.add_option("--duration", options->duration_s,
                 "Length of the session in seconds; 0: until stopped")
      ->check(node::IsTime(node::Zero::kAllowed));
  app.add_flag(
      "--arm", options->arm,
      "Armed from the first tick, in real time once a controller answers (simulation only)");
  app.add_option(
         "--await", options->await,
         "Lockstep: topics whose answer ends a tick, comma-separated; TOPIC:WINDOW lets it lag")
      ->delimiter(',');
  app.add_option(
         "--await-timeout", options->await_timeout_s,
         "Seconds after which a missing answer is an error (lockstep), or --arm is given up")
      ->check(node::IsTime(node::Zero::kRefused))
      ->capture_default_str();
}

void Describe(config::Fields& f, GuardConfig& c) {
  auto fault_after_ms = c.fault_after.count();
  f("missed_periods", c.missed_periods, {1, 100}, "without their commands: bridge the gap");
  f("fault_after_ms", fault_after_ms, {1, 10000}, "older than this: latched fault");
  c.fault_after = std::chrono::milliseconds(fault_after_ms);
  f.Word("bridging", c.bridging, {{"damp", Bridging::kDamp}, {"hold", Bridging::kHold}},
         "what bridges it");
  f.Word("on_joint_fault", c.on_joint_fault,
         {{"idle", OtherJointsPolicy::kIdle},
          {"damp", OtherJointsPolicy::kDamp},
          {"hold", OtherJointsPolicy::kHold},
          {"continue", OtherJointsPolicy::kContinue}},
         "what the other joints do");
  f.Word("valves_in_fault", c.valves_in_fault,
         {{"hold", ValvesInFault::kHold}, {"vent", ValvesInFault::kVent}}, "air of the chambers");
  f("damping_Nm_s_rad", c.damping_Nm_s_rad, config::kNotNegative, "motor side, per motor rad/s");
  f.If("fall", "of a robot on two legs: a fall is a fault", [&c](config::Fields& fall) {
    FallGuardConfig guard;
    Describe(fall, guard);
    fall.Word("on_fall", c.on_fall, {{"idle", FallPolicy::kIdle}, {"damp", FallPolicy::kDamp}},
              "what the joints do");
    c.fall = std::make_shared<const FallGuardConfig>(guard);
  });
}

GuardConfig LoadGuardConfig(const config::Section& guard) {
  GuardConfig config;
  config::Fields fields(guard);
  Describe(fields, config);
  return config;
}

}  // namespace sinew::provider
