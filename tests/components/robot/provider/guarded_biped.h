// A biped without dynamics behind a provider's cycle: legs that follow what they are asked, some
// milliseconds late, and a body whose sensors have the noise and bias of
// tests/components/robot/fall/fall_world.h. Lengths: robots/biped.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <string>

#include "components/bodies/leg/squat.h"
#include "components/robot/provider/provider_cycle.h"
#include "tests/components/robot/fall/fall_world.h"

namespace sinew::provider {

inline constexpr std::uint64_t kBipedSession = 42;
inline constexpr double kBipedRate_Hz = 240.0;
inline constexpr double kBipedPeriod_s = 1.0 / kBipedRate_Hz;
inline constexpr double kSole_m = 0.134;      // below the ankle roll axis
inline constexpr double kAnkle_m = 0.104;     // between the ankle's axes
inline constexpr double kHighest_m = 0.756;   // of the base above the ground: straight less 0.02 m
inline constexpr double kAmplitude_m = 0.19;  // of the squats: down to 0.4 m below straight legs
inline constexpr double kSquat_rad_s = 0.2 * types::kTwoPi;
inline constexpr double kDetection_s = 0.100;
inline constexpr double kStarted_s = 2.5;  // the detector has started: 2 s, and a margin

inline GuardedLeg BipedLeg(int first_joint, double hip_y_m) {
  GuardedLeg leg;
  leg.geometry.hip_in_pelvis_m = {0.0, hip_y_m, 0.0};
  leg.geometry.thigh_m = 0.278;
  leg.geometry.shank_m = 0.260;
  leg.geometry.ankle_offset_m = kAnkle_m;
  leg.geometry.sole_in_ankle_m = {0.0, 0.0, -kSole_m};
  for (int i = 0; i < leg::kLegJoints; ++i) {
    leg.joint[static_cast<std::size_t>(i)] = first_joint + i;
  }
  return leg;
}

inline FallGuardConfig BipedFallGuard() {
  FallGuardConfig config;
  config.joint_count = types::kMaxJoints;
  config.left = BipedLeg(0, 0.075);
  config.right = BipedLeg(leg::kLegJoints, -0.075);
  return config;
}

// Of both legs, torso upright, soles flat.
inline types::JointArray<double> SquatAngles(double base_height_m) {
  const GuardedLeg leg = BipedLeg(0, 0.075);
  const auto squat =
      leg::SquatAt(leg.geometry, 0.0, {.height_m = base_height_m - kAnkle_m - kSole_m});
  EXPECT_TRUE(squat) << base_height_m;
  types::JointArray<double> angles{};
  for (const std::size_t first : {0, leg::kLegJoints}) {
    angles[first + leg::kHipPitch] = squat->hip_pitch.position_rad;
    angles[first + leg::kKnee] = squat->knee.position_rad;
    angles[first + leg::kAnklePitch] = squat->ankle_pitch.position_rad;
  }
  return angles;
}

// The squats of robots/biped after since_s, 5 s each.
inline double SquatHeight_m(double since_s) {
  if (since_s <= 0.0) return kHighest_m;
  return kHighest_m - kAmplitude_m * (1.0 - std::cos(kSquat_rad_s * since_s));
}

class GuardedBiped {
 public:
  struct Now {
    fall::BodyState body;         // leg_m: of the base above the ground
    double asked_m = kHighest_m;  // what the controller commands
    types::ControlMode mode = types::ControlMode::kPosition;
    bool commands = true;
    bool imu_valid = true, feet_valid = true, encoders_valid = true;
  };

  explicit GuardedBiped(const GuardConfig& guard, std::uint64_t seed = 1,
                        const FallGuardConfig& fall = BipedFallGuard())
      : sensor_model_(seed), cycle_(ConfigOf(guard, fall)) {}

  ProviderCycle& cycle() { return cycle_; }
  double time_s() const { return static_cast<double>(tick_) * kBipedPeriod_s; }
  std::uint64_t tick() const { return tick_; }
  // Of the last step.
  const PlantCommand& command() const { return *command_; }
  FaultChange change() const { return change_; }

  void Step(const Now& now) {
    (void)cycle_.Begin(tick_, 0);
    if (now.commands) (void)cycle_.Take(CommandFor(now), tick_);
    command_ = &cycle_.Command(tick_, sensors_);
    Read(now);
    (void)cycle_.Observe(sensors_);
    change_ = cycle_.ObserveBody(tick_, sensors_, body_);
    ++tick_;
  }

  // Stands until the detector has started, then is armed by an operator.
  void StandAndArm() {
    while (time_s() < kStarted_s) Step({});
    ASSERT_EQ(Arm(), OperatorResult::kDone) << cycle_.FallRefusal();
    Step({});
    ASSERT_EQ(cycle_.state(), types::RobotState::kArmed);
  }
  OperatorResult Arm() {
    return cycle_.Take(
        OperatorCommand{.session_id = kBipedSession, .action = types::OperatorAction::kArm}, tick_);
  }
  OperatorResult Reset() {
    return cycle_.Take(
        OperatorCommand{.session_id = kBipedSession, .action = types::OperatorAction::kReset},
        tick_);
  }

  // Steps until the robot is in FAULT, for at most limit_s; seconds since the first of these steps.
  template <class NowAt>
  std::optional<double> FaultAfter_s(double limit_s, const NowAt& now_at) {
    const double begin_s = time_s();
    while (time_s() - begin_s <= limit_s) {
      const double since_s = time_s() - begin_s;
      Step(now_at(since_s));
      if (cycle_.state() == types::RobotState::kFault) return since_s;
    }
    return std::nullopt;
  }

 private:
  static CycleConfig ConfigOf(GuardConfig guard, const FallGuardConfig& fall) {
    guard.fall = std::make_shared<const FallGuardConfig>(fall);
    return {.guard = guard,
            .session_id = kBipedSession,
            .joint_count = types::kMaxJoints,
            .rate_Hz = kBipedRate_Hz};
  }

  JointSetpoints CommandFor(const Now& now) const {
    JointSetpoints command;
    command.header = {.session_id = kBipedSession, .tick = tick_, .origin = types::Origin::kSim};
    command.joint_count = types::kMaxJoints;
    command.mode.fill(now.mode);
    command.motor_torque_Nm.fill(0.01);
    command.position_rad = SquatAngles(now.asked_m);
    return command;
  }

  void Read(const Now& now) {
    sensors_.position_rad = SquatAngles(now.body.leg_m);
    sensors_.valid.fill(now.encoders_valid);
    const fall::FallInput read = sensor_model_.Read(tick_, time_s(), now.body);
    for (std::size_t i = 0; i < 3; ++i) {
      body_.acceleration_m_s2[i] = read.imu.force_m_s2[static_cast<Eigen::Index>(i)];
      body_.angular_velocity_rad_s[i] = read.imu.rate_rad_s[static_cast<Eigen::Index>(i)];
    }
    body_.imu_valid = now.imu_valid;
    body_.foot_force_N = read.feet.force_N;
    body_.foot_valid.fill(now.feet_valid);
  }

  fall::SensorModel sensor_model_;
  ProviderCycle cycle_;
  PlantSensors sensors_;
  BodySensors body_;
  const PlantCommand* command_ = nullptr;
  FaultChange change_ = FaultChange::kNone;
  std::uint64_t tick_ = 0;
};

}  // namespace sinew::provider
