// The target equation of a biped on both soles: what the rigid bodies need is carried over.
#include <gtest/gtest.h>

#include "components/learn/rls/target.h"
#include "tests/components/bodies/stance/biped.h"
#include "tests/components/bodies/stance/biped_model.h"

namespace sinew::rls {
namespace {

using esn::Signal;

constexpr double kTick_s = 1.0 / 240.0;
constexpr int kHalf = 2;

// At rest in one squat while the reference asks for another, deeper one, with a payload's torque in
// each joint that the model does not know.
TEST(TargetEquationOfABiped, CarriesTheBodiesFromTheMotionToTheReference) {
  const arm::Chain chain = stance::ReadNuBiped();
  const actuator::RobotModel robot = stance::BipedModel(chain);
  stance::DoubleSupport both(chain);
  const leg::LegGeometry geometry = leg::GeometryOf(chain, leg::NamesOfSide("left"), "left_sole");
  const auto squat = [&](double depth_m) {
    return stance::Squat(both.dynamics(), geometry,
                         {leg::StraightHeight(geometry, 0.0) - depth_m, 0.0, 0.0});
  };
  const stance::JointsMotion motion = squat(0.2), reference = squat(0.25);
  const Eigen::VectorXd at_motion = both.Solve(motion.q, motion.v, motion.a).torque;
  const Eigen::VectorXd at_reference = both.Solve(reference.q, reference.v, reference.a).torque;

  const int joints = static_cast<int>(robot.joints.size());
  esn::Hyperparameters hyper;
  hyper.neurons = 5;
  hyper.density = 0.5;
  esn::Weights weights = esn::MakeWeights(hyper, 3 * joints, joints);
  weights.inputs.clear();
  for (const Signal signal :
       {Signal::kReferencePosition, Signal::kReferenceVelocity, Signal::kReferenceAcceleration}) {
    for (int j = 0; j < joints; ++j) weights.inputs.push_back({signal, j});
  }
  weights.input.offset.setZero();
  weights.input.scale.setConstant(2.0);

  TargetConfig config;
  config.half_window_ticks = kHalf;
  config.motion_from_motor = false;
  config.stance = esn::StanceConfig{chain, stance::DoubleSupportConfig{}};
  TargetEquation equation(config, robot, std::nullopt, weights);

  Eigen::VectorXd features = Eigen::VectorXd::Zero(weights.feature_count());
  features[0] = 1.0;
  const auto unknown_Nm = [](int joint) { return 0.3 * joint - 1.0; };
  TickData data{.features = features};
  data.period_s = kTick_s;
  data.usable = data.positions_valid = true;
  data.network = 1;
  for (int j = 0; j < joints; ++j) {
    const auto at = static_cast<std::size_t>(j);
    const Eigen::Index of = stance::JointIndex(both.dynamics(), robot.joints[at].name);
    features[1 + j] = reference.q[of] / 2.0;
    data.position_rad[at] = motion.q[of];
    data.drive_torque_Nm[at] = at_motion[of] + unknown_Nm(j);
  }
  for (data.tick = 1; data.tick <= 2 * kHalf; ++data.tick) {
    EXPECT_FALSE(equation.Push(data).has_value()) << "no whole window yet";
  }
  const std::optional<TargetEquation::Sample> sample = equation.Push(data);
  ASSERT_TRUE(sample.has_value());
  for (int j = 0; j < joints; ++j) {
    const Eigen::Index of =
        stance::JointIndex(both.dynamics(), robot.joints[static_cast<std::size_t>(j)].name);
    // Second differences of constant positions: rounding over the square of the period.
    EXPECT_NEAR(sample->target_Nm[j], at_reference[of] + unknown_Nm(j), 1e-8);
  }
  EXPECT_GT((at_reference - at_motion).norm(), 1.0) << "the squats need different torques";
}

}  // namespace
}  // namespace sinew::rls
