// Readings of the sensors that are not finite: what the provider makes of them itself, damping and
// holding, reaches the plant as numbers.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "components/robot/provider/provider_cycle.h"

namespace sinew::provider {
namespace {

constexpr std::uint64_t kSensorsSession = 42;

// Armed, with one accepted command, which is overdue five ticks later.
ProviderCycle OverdueSoon(Bridging bridging) {
  CycleConfig config;
  config.guard.bridging = bridging;
  config.session_id = kSensorsSession;
  ProviderCycle cycle(config);
  cycle.ArmAtStart();
  JointSetpoints command;
  command.header = {.session_id = kSensorsSession, .tick = 0, .origin = types::Origin::kSim};
  command.joint_count = 1;
  command.mode[0] = types::ControlMode::kTorque;
  EXPECT_TRUE(cycle.Take(command, 0));
  (void)cycle.Command(0, {});
  return cycle;
}

PlantSensors Broken() {
  PlantSensors sensors;
  sensors.position_rad[0] = sensors.motor_velocity_rad_s[0] =
      std::numeric_limits<double>::quiet_NaN();
  return sensors;
}

TEST(UntrustedSensors, AJointWhoseVelocityIsNotANumberIsDampedWithoutTorque) {
  ProviderCycle cycle = OverdueSoon(Bridging::kDamp);
  const PlantCommand& command = cycle.Command(5, Broken());
  EXPECT_EQ(cycle.state(), types::RobotState::kDamped);
  EXPECT_EQ(command.mode[0], types::ControlMode::kTorque);
  EXPECT_EQ(command.motor_torque_Nm[0], 0.0);
}

TEST(UntrustedSensors, AJointWhosePositionIsNotANumberIdlesInsteadOfHoldingUntilTheGapEnds) {
  ProviderCycle cycle = OverdueSoon(Bridging::kHold);
  for (const std::uint64_t tick : {5u, 6u}) {
    PlantSensors sensors = Broken();
    if (tick == 6) sensors.position_rad[0] = 0.3;  // known too late: where it held is not
    const PlantCommand& command = cycle.Command(tick, sensors);
    EXPECT_EQ(command.mode[0], types::ControlMode::kIdle);
    EXPECT_TRUE(std::isfinite(command.position_rad[0]));
  }
}

}  // namespace
}  // namespace sinew::provider
