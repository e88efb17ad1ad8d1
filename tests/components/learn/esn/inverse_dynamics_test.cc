#include "components/learn/esn/inverse_dynamics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "components/model/actuator/file/model_file.h"

namespace sinew::esn {
namespace {

actuator::RobotModel Rig() {
  return actuator::LoadRobotModel(SINEW_SOURCE_DIR "/robots/rig/model.yaml");
}

struct Point {
  double q, v, a, pressure, load, payload;
};

Frame FrameAt(const Point& p) {
  Frame frame;
  frame.Set(Signal::kReferencePosition, 0, p.q);
  frame.Set(Signal::kReferenceVelocity, 0, p.v);
  frame.Set(Signal::kReferenceAcceleration, 0, p.a);
  frame.Set(Signal::kChamberPressure, 0, p.pressure);
  frame.Set(Signal::kLoadForce, 0, p.load);
  frame.Set(Signal::kPayload, 0, p.payload);
  return frame;
}

// The declared balance of the rig, written out.
double Balance(const actuator::JointModel& m, const Point& p) {
  const auto value = [&](const char* effect, const char* parameter) {
    return m.Parameter(effect, parameter);
  };
  const double inertia = value("rotor_inertia", "rotor_inertia") +
                         value("link_inertia", "link_inertia") + p.payload * 0.3 * 0.3;
  return inertia * p.a + value("motor_viscous", "viscous") * p.v +
         value("coulomb", "coulomb") * (p.v > 0 ? 1 : -1) +
         (value("gravity", "gravity_torque") + p.payload * 9.81 * 0.3) * std::cos(p.q) -
         value("pneumatic_torque", "pneumatic_torque") * p.pressure +
         value("pneumatic_stiffness", "pneumatic_stiffness") * p.pressure *
             (p.q - value("pneumatic_stiffness", "rest_angle")) +
         0.3 * p.load;
}

TEST(InverseDynamics, IsTheDeclaredBalanceOfTheRig) {
  const actuator::RobotModel rig = Rig();
  InverseDynamics inverse(rig, 0.05);
  for (const Point& p : {Point{0.0, 1.0, 0.0, 0.0, 0.0, 0.0},
                         {0.4, -1.2, 5.0, 4.0, 0.0, 0.0},
                         {-0.7, 0.3, -8.0, 2.5, 6.0, 0.5}}) {
    const Prediction prediction = inverse.Step(FrameAt(p), 1.0 / 240.0);
    ASSERT_TRUE(prediction.valid[0]);
    EXPECT_NEAR(prediction.torque_Nm[0], Balance(rig.joints[0], p), 1e-12);
  }
}

TEST(InverseDynamics, DryFrictionTurnsSmoothlyThroughZeroVelocity) {
  const actuator::RobotModel rig = Rig();
  InverseDynamics inverse(rig, 0.05);
  const auto torque = [&](double v) {
    return inverse.Step(FrameAt({0.2, v, 0.0, 3.0, 0.0, 0.0}), 0.01).torque_Nm[0];
  };
  const double up = torque(0.05);
  const double down = torque(-0.05);
  EXPECT_NEAR(torque(0.0), 0.5 * (up + down), 1e-12);
  EXPECT_NEAR(torque(0.025), 0.25 * down + 0.75 * up, 1e-12);
  EXPECT_NEAR(torque(0.05 + 1e-9), up, 1e-6);
  EXPECT_GT(up - down, 0.4);
}

// The plant is the model: with measured position and velocity and feedback on the acceleration the
// error obeys e'' + Kd e' + Kp e = 0, here critically damped.
TEST(InverseDynamics, ComputedTorqueMakesTheErrorALinearOscillator) {
  const actuator::RobotModel rig = Rig();
  constexpr double kRate_1_s = 10.0, kStep_s = 1e-5;
  InverseDynamicsConfig config{.robot = rig, .stance = std::nullopt};
  config.state = MotionState::kMeasured;
  config.proportional_1_s2 = kRate_1_s * kRate_1_s;
  config.derivative_1_s = 2.0 * kRate_1_s;
  InverseDynamics inverse(config);
  const auto value = [&](const char* effect, const char* parameter) {
    return rig.joints[0].Parameter(effect, parameter);
  };
  const double inertia =
      value("rotor_inertia", "rotor_inertia") + value("link_inertia", "link_inertia");
  constexpr double kStart_rad = 0.3, kReference_rad_s = 0.8;
  double q = -kStart_rad, v = kReference_rad_s;  // the reference: 0.8 rad/s through 0
  for (int k = 0; k < 40000; ++k) {
    const double t_s = kStep_s * k;
    Frame frame = FrameAt({kReference_rad_s * t_s, kReference_rad_s, 0.0, 2.0, 0.0, 0.0});
    frame.Set(Signal::kPosition, 0, q);
    frame.Set(Signal::kVelocity, 0, v);
    const Prediction prediction = inverse.Step(frame, kStep_s);
    ASSERT_TRUE(prediction.valid[0]);
    if (k % 1000 == 0) {
      const double expected = kStart_rad * (1.0 + kRate_1_s * t_s) * std::exp(-kRate_1_s * t_s);
      // First order in the step: rate x step of the error.
      EXPECT_NEAR(kReference_rad_s * t_s - q, expected, 2.0 * kRate_1_s * kStep_s * kStart_rad);
    }
    const double passive = Balance(rig.joints[0], {q, v, 0.0, 2.0, 0.0, 0.0});
    v += kStep_s * (prediction.torque_Nm[0] - passive) / inertia;
    q += kStep_s * v;
  }
}

// Feedback adds Kp e + Kd e' to the acceleration, wherever the motion is taken from.
TEST(InverseDynamics, FeedbackActsOnTheAcceleration) {
  const actuator::RobotModel rig = Rig();
  InverseDynamicsConfig config{.robot = rig, .stance = std::nullopt};
  config.proportional_1_s2 = 40.0;
  config.derivative_1_s = 6.0;
  InverseDynamics inverse(config);
  Frame frame = FrameAt({0.4, 1.2, 5.0, 4.0, 0.0, 0.0});
  frame.Set(Signal::kPosition, 0, 0.3);
  frame.Set(Signal::kVelocity, 0, 1.0);
  EXPECT_NEAR(inverse.Step(frame, 0.01).torque_Nm[0],
              Balance(rig.joints[0], {0.4, 1.2, 5.0 + 40.0 * 0.1 + 6.0 * 0.2, 4.0, 0.0, 0.0}),
              1e-12);
  frame.Set(Signal::kVelocity, 0, std::nan(""));
  EXPECT_FALSE(inverse.Step(frame, 0.01).valid[0]);
}

TEST(InverseDynamics, SaysSoWhenTheReferenceIsNotKnown) {
  InverseDynamics inverse(Rig(), 0.05);
  const Prediction nothing = inverse.Step(Frame{}, 0.01);
  EXPECT_FALSE(nothing.valid[0]);
  EXPECT_EQ(nothing.torque_Nm[0], 0.0);
  EXPECT_EQ(nothing.joint_count, 1);
  const Prediction infinite = inverse.Step(FrameAt({0.0, 1.0, INFINITY, 0.0, 0.0, 0.0}), 0.01);
  EXPECT_FALSE(infinite.valid[0]);
}

TEST(InverseDynamics, RefusesWhatCannotBe) {
  EXPECT_THROW(InverseDynamics(actuator::RobotModel{}, 0.05), std::invalid_argument);
  EXPECT_THROW(InverseDynamics(Rig(), 0.0), std::invalid_argument);
  EXPECT_THROW(InverseDynamics(Rig(), std::nan("")), std::invalid_argument);
  InverseDynamicsConfig config{.robot = Rig(), .stance = std::nullopt};
  config.derivative_1_s = -1.0;
  EXPECT_THROW(InverseDynamics{config}, std::invalid_argument);
}

}  // namespace
}  // namespace sinew::esn
