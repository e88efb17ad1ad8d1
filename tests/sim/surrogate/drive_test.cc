#include "sim/surrogate/drive.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "components/base/types/control_mode.h"

namespace sinew::surrogate {
namespace {

constexpr double kDriveStep_s = 1.0 / 8000.0;

TEST(TrackingObserver, FollowsARampWithoutALastingError) {
  TrackingObserver observer(100.0);
  for (int i = 0; i <= 8000; ++i) observer.Step(3.0 * i * kDriveStep_s, kDriveStep_s);
  EXPECT_NEAR(observer.velocity_rad_s(), 3.0, 1e-6);
  EXPECT_NEAR(observer.angle_rad(), 3.0, 1e-6);
}

TEST(TrackingObserver, LagsLikeACriticallyDampedSecondOrderSystem) {
  // Unit step in angle: velocity = b^2 t exp(-b t), largest b/e at 1/b.
  TrackingObserver observer(100.0);
  double largest = 0.0;
  for (int i = 0; i < 800; ++i) {
    observer.Step(1.0, kDriveStep_s);
    largest = std::max(largest, observer.velocity_rad_s());
  }
  EXPECT_NEAR(largest, 100.0 / std::exp(1.0), 0.03 * 100.0 / std::exp(1.0));
}

TEST(Drive, IdleAsksForNoTorque) {
  Drive drive{DriveParameters{}};
  DriveCommand command{types::ControlMode::kIdle, 0.3, 5.0, 2.0};
  EXPECT_EQ(drive.Step(command, 1.0, kDriveStep_s), 0.0);
}

TEST(Drive, TorqueModePassesTheTorqueUpToItsLimit) {
  Drive drive{DriveParameters{}};
  EXPECT_EQ(drive.Step({types::ControlMode::kTorque, 0.1}, 0.0, kDriveStep_s), 0.1);
  EXPECT_EQ(drive.Step({types::ControlMode::kTorque, 9.0}, 0.0, kDriveStep_s), 0.398);
  EXPECT_EQ(drive.Step({types::ControlMode::kTorque, -9.0}, 0.0, kDriveStep_s), -0.398);
}

TEST(Drive, PositionAndVelocityModesBringAFreeRotorThere) {
  constexpr double kRotor_kg_m2 = 1.15e-5;
  for (const types::ControlMode mode :
       {types::ControlMode::kPosition, types::ControlMode::kVelocity}) {
    Drive drive{DriveParameters{}};
    double angle_rad = 0.0, velocity_rad_s = 0.0;
    for (int i = 0; i < 16000; ++i) {
      const DriveCommand command{mode, 0.0, 10.0,
                                 mode == types::ControlMode::kVelocity ? 40.0 : 0.0};
      velocity_rad_s += kDriveStep_s * drive.Step(command, angle_rad, kDriveStep_s) / kRotor_kg_m2;
      angle_rad += kDriveStep_s * velocity_rad_s;
    }
    if (mode == types::ControlMode::kPosition) {
      EXPECT_NEAR(angle_rad, 10.0, 1e-3);
    } else {
      EXPECT_NEAR(velocity_rad_s, 40.0, 0.01);
    }
  }
}

TEST(Drive, RefusesAnEstimatorFasterThanItsRateAllows) {
  EXPECT_THROW(Drive({.rate_Hz = 1000.0, .estimator_bandwidth_rad_s = 900.0}),
               std::invalid_argument);
  EXPECT_THROW(Drive({.torque_limit_Nm = 0.0}), std::invalid_argument);
}

}  // namespace
}  // namespace sinew::surrogate
