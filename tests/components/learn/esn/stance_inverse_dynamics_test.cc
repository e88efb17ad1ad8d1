// The stand-in for the networks of a biped on both soles: robots/biped with rotors and friction.
#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "components/learn/esn/inverse_dynamics.h"
#include "tests/components/bodies/stance/biped.h"
#include "tests/components/bodies/stance/biped_model.h"
#include "tests/components/robot/control/terms.h"
#include "tests/support/allocations.h"
#include "tests/support/rig_constants.h"

namespace sinew::esn {
namespace {

constexpr double kSmoothing_rad_s = 0.02;

class StanceInverseDynamics : public testing::Test {
 protected:
  arm::Chain chain_ = stance::ReadNuBiped();
  actuator::RobotModel robot_ = stance::BipedModel(chain_);
  stance::DoubleSupport stance_{chain_};
  stance::JointsMotion squat_ = stance::Squat(
      stance_.dynamics(), Geometry(), {leg::StraightHeight(Geometry(), 0.0) - 0.2, -0.4, 2.0});

  leg::LegGeometry Geometry() const {
    return leg::GeometryOf(chain_, leg::NamesOfSide("left"), "left_sole");
  }
  InverseDynamicsConfig Config() const {
    return {.robot = robot_,
            .smoothing_rad_s = kSmoothing_rad_s,
            .stance = StanceConfig{chain_, stance::DoubleSupportConfig{}}};
  }
  Eigen::Index OfRobot(std::size_t joint) const {
    return stance::JointIndex(stance_.dynamics(), robot_.joints[joint].name);
  }
  Frame FrameOf(const stance::JointsMotion& motion) const {
    Frame frame;
    for (std::size_t j = 0; j < robot_.joints.size(); ++j) {
      const int index = static_cast<int>(j);
      frame.Set(Signal::kReferencePosition, index, motion.q[OfRobot(j)]);
      frame.Set(Signal::kReferenceVelocity, index, motion.v[OfRobot(j)]);
      frame.Set(Signal::kReferenceAcceleration, index, motion.a[OfRobot(j)]);
    }
    return frame;
  }
};

TEST_F(StanceInverseDynamics, IsTheBodiesWithRotorsAndFriction) {
  InverseDynamics inverse(Config());
  const Prediction prediction = inverse.Step(FrameOf(squat_), kCycle_s);
  ASSERT_EQ(prediction.joint_count, 12);
  const Eigen::VectorXd bodies = stance_.Solve(squat_.q, squat_.v, squat_.a).torque;
  for (std::size_t j = 0; j < 12; ++j) {
    const double v = squat_.v[OfRobot(j)], a = squat_.a[OfRobot(j)];
    const double direction =
        std::abs(v) < kSmoothing_rad_s ? v / kSmoothing_rad_s : std::copysign(1.0, v);
    ASSERT_TRUE(prediction.valid[j]);
    EXPECT_NEAR(prediction.torque_Nm[j],
                bodies[OfRobot(j)] + stance::kRotor_kg_m2 * a + stance::kViscous_Nm_s_rad * v +
                    stance::kCoulomb_Nm * direction,
                1e-11)
        << robot_.joints[j].name;
  }
  EXPECT_GT(std::abs(bodies[OfRobot(3)]), 5.0) << "the knee carries";
  ASSERT_NE(inverse.stance(), nullptr);
  EXPECT_GT(inverse.stance()->least_normal_N, 0.0);
}

// A model file that close-loop has fitted states the share itself.
TEST_F(StanceInverseDynamics, AShareOfTheBodiesInTheModelCounts) {
  InverseDynamicsConfig config = Config();
  control::AddTerm(&config.robot.joints[3], "rigid_body", {0.9});
  InverseDynamics whole(Config()), share(config);
  stance::JointsMotion still = squat_;
  still.v.setZero();
  still.a.setZero();
  const double torque_Nm = whole.Step(FrameOf(still), kCycle_s).torque_Nm[3];
  EXPECT_NEAR(share.Step(FrameOf(still), kCycle_s).torque_Nm[3], 0.9 * torque_Nm, 1e-11);
}

TEST_F(StanceInverseDynamics, OneJointWithoutAMotionLeavesNoneValid) {
  InverseDynamics inverse(Config());
  Frame frame = FrameOf(squat_);
  frame.Set(Signal::kReferenceAcceleration, 7, std::nan(""));
  const Prediction prediction = inverse.Step(frame, kCycle_s);
  EXPECT_EQ(prediction.joint_count, 12);
  for (std::size_t j = 0; j < 12; ++j) {
    EXPECT_FALSE(prediction.valid[j]);
    EXPECT_EQ(prediction.torque_Nm[j], 0.0);
  }
}

TEST_F(StanceInverseDynamics, RefusesModelsThatAreNotOfThisRobot) {
  const auto refuses = [](const InverseDynamicsConfig& config) {
    EXPECT_THROW(InverseDynamics{config}, std::invalid_argument);
  };
  InverseDynamicsConfig bad = Config();
  bad.robot.joints[2].name = "tail";
  refuses(bad);
  bad = Config();
  bad.robot.joints.pop_back();
  refuses(bad);
  bad = Config();
  control::AddTerm(&bad.robot.joints[4], "gravity", {1.0});
  refuses(bad);
  bad = Config();
  bad.stance->soles.soles[0].frame = "left_hand";
  refuses(bad);
}

TEST_F(StanceInverseDynamics, StepsWithoutAllocations) {
  InverseDynamics inverse(Config());
  const Frame frame = FrameOf(squat_);
  (void)inverse.Step(frame, kCycle_s);
  const long before = test::Allocations();
  for (int k = 0; k < 10; ++k) (void)inverse.Step(frame, kCycle_s);
  EXPECT_EQ(test::Allocations(), before);
}

}  // namespace
}  // namespace sinew::esn
