#include "components/esn/inverse_dynamics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "components/actuator/file/model_file.h"

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
}

}  // namespace
}  // namespace sinew::esn
