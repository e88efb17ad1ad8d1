// Torques of a known arm with known friction, along sums of sines; the model starts from bodies
// that are wrong.
#include "components/model/arm/arm_fit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <stdexcept>

#include "components/bodies/links/fixed_links.h"
#include "components/model/arm/arm_loop.h"
#include "components/model/identify/balance.h"
#include "tests/components/bodies/dynamics/random_arm.h"

namespace sinew::arm {
namespace {

using types::Signal;

// All joints revolute, as one model file has one kind of joint in its mapping.
Chain Revolute(double scale) {
  Chain chain = RandomArm();
  for (Body& body : chain.bodies) {
    body.prismatic = false;
    body.mass_kg *= scale;
    body.com_m *= scale;
    body.inertia_kg_m2 *= scale;
  }
  return chain;
}

actuator::RobotModel Model(double coulomb, double viscous) {
  actuator::RobotModel robot;
  for (const char* name : {"one", "two", "slide", "last"}) {
    actuator::JointModel joint;
    joint.name = name;
    const auto add = [&](const char* effect, double value, bool fixed) {
      joint.terms.push_back(actuator::MakeTerm(effect, joint.constants));
      joint.terms.back().linear[0].value = value;
      joint.terms.back().linear[0].fixed = fixed;
    };
    add("drive_torque", 1.0, true);
    add("rigid_body", 1.0, true);
    add("coulomb", coulomb, false);
    add("viscous", viscous, false);
    robot.joints.push_back(joint);
  }
  return robot;
}

ArmRuns Recorded(double seconds, std::uint64_t seed, const Chain& chain = Revolute(1.0)) {
  const ArmDynamics truth(chain);
  const auto n = static_cast<Eigen::Index>(200.0 * seconds);
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> phase(0.0, 6.28);
  std::normal_distribution<double> normal;
  Eigen::MatrixXd phases(4, 3);
  for (double& p : phases.reshaped()) p = phase(random);
  constexpr double kAmplitude_rad[] = {0.8, 0.4, 0.15};
  constexpr double kFrequency_Hz[] = {0.13, 0.37, 0.81};
  ArmRuns runs(4);
  for (auto& of_joint : runs) {
    types::Run run;
    run.name = "run_" + std::to_string(seed);
    run.time_s = Eigen::VectorXd::LinSpaced(n, 0.0, static_cast<double>(n - 1) / 200.0);
    run.signals[Signal::kPosition] = Eigen::VectorXd(n);
    run.signals[Signal::kTorque] = Eigen::VectorXd(n);
    of_joint = {run};
  }
  for (Eigen::Index i = 0; i < n; ++i) {
    Eigen::VectorXd q = Eigen::VectorXd::Zero(4), v = q, a = q;
    for (int j = 0; j < 4; ++j) {
      for (int k = 0; k < 3; ++k) {
        const double w = 2.0 * M_PI * kFrequency_Hz[k] * (1.0 + 0.07 * j);
        const double angle = w * static_cast<double>(i) / 200.0 + phases(j, k);
        q[j] += kAmplitude_rad[k] * std::sin(angle);
        v[j] += kAmplitude_rad[k] * w * std::cos(angle);
        a[j] -= kAmplitude_rad[k] * w * w * std::sin(angle);
      }
    }
    const Eigen::VectorXd torque = truth.Torque(q, v, a, truth.nominal());
    for (int j = 0; j < 4; ++j) {
      auto& signals = runs[static_cast<std::size_t>(j)][0].signals;
      signals[Signal::kPosition][i] = q[j];
      signals[Signal::kTorque][i] =
          torque[j] + 0.3 * (v[j] > 0.0 ? 1.0 : -1.0) + 0.5 * v[j] + 0.01 * normal(random);
    }
  }
  return runs;
}

identify::ProcessingOptions Options() {
  identify::ProcessingOptions options;
  options.state_cutoff_Hz = 20.0;
  options.parallel_cutoff_Hz = 5.0;
  options.rest_velocity = 0.03;
  return options;
}

TEST(ArmFit, WrongBodiesAndFrictionAreMendedAndHoldOnAnotherRecording) {
  const actuator::RobotModel robot = Model(0.1, 0.1);
  const Arm arm(Revolute(0.8), robot);
  const ArmRuns train = Recorded(40.0, 1), held_out = Recorded(20.0, 2);
  const ArmFit fit = arm.Fit(train, robot, Options());
  EXPECT_NEAR(fit.robot.joints[1].Parameter("coulomb", "coulomb"), 0.3, 0.01);
  EXPECT_NEAR(fit.robot.joints[2].Parameter("viscous", "viscous"), 0.5, 0.02);
  const ArmError before = arm.ErrorOf(held_out, robot, arm.dynamics().nominal(), Options());
  const ArmError after = arm.ErrorOf(held_out, fit.robot, fit.phi, Options());
  EXPECT_GT(before.all_relative_percent, 20.0);
  EXPECT_LT(after.all_relative_percent, 1.0);
  EXPECT_NEAR(after.nrms_percent,
              (after.rms_Nm[0] + after.rms_Nm[1] + after.rms_Nm[2] + after.rms_Nm[3]) / 4.0, 1e-9);
  // The base parameters are those of the truth.
  const ArmDynamics truth(Revolute(1.0));
  const Eigen::VectorXd beta = arm.base().Of(truth.nominal());
  for (std::size_t i = 0; i < fit.base.size(); ++i) {
    EXPECT_NEAR(fit.base[i].value, beta[static_cast<Eigen::Index>(i)],
                std::max(0.02, 2.0 * fit.base[i].half_width_95))
        << fit.base[i].name;
  }
}

TEST(ArmFit, TheRigidTorqueReachesTheJointsOwnBalance) {
  const actuator::RobotModel robot = Model(0.3, 0.5);
  const Arm arm(Revolute(1.0), robot);
  ArmRuns runs = Recorded(20.0, 3);
  arm.AddRigidTorque(arm.Fit(runs, robot, Options()), std::vector(4, Options()), robot, &runs);
  for (std::size_t j = 0; j < 4; ++j) {
    const identify::Design design(identify::MakeStates(runs[j], robot.joints[j], Options()),
                                  Options());
    EXPECT_LT(identify::ErrorOf(design, robot.joints[j]).rms, 0.03) << j;
  }
}

TEST(ArmFit, TheOtherJointsSayHowFarARefitMayChangeTheBodies) {
  const actuator::RobotModel robot = Model(0.3, 0.5);
  const Arm arm(Revolute(1.0), robot);
  // In standard deviations: how far the fit of all lies from what all but joint j say.
  const auto farthest = [&](const ArmRuns& runs, std::size_t j) {
    const RigidPrior prior = arm.Fit(runs, robot, Options()).by_others[j];
    double most = 0.0;
    for (Eigen::Index k = 0; k < prior.mean.size(); ++k) {
      if (prior.spread[k] > 0.0) most = std::max(most, std::abs(prior.mean[k]) / prior.spread[k]);
    }
    return most;
  };
  ArmRuns runs = Recorded(40.0, 4);
  const double clean = farthest(runs, 1);
  EXPECT_LT(clean, 4.0);
  // A drive that gives a fifth more on one joint alone: its bodies would be heavier, the others
  // say that they are not.
  runs[1][0].signals[Signal::kTorque] *= 1.2;
  EXPECT_GT(farthest(runs, 1), std::max(4.0, 2.0 * clean));
}

TEST(ArmFit, ARefitOfTheBodiesIsInTheColumnsThatTheJointCarries) {
  const actuator::RobotModel robot = Model(0.3, 0.5);
  const Arm arm(Revolute(1.0), robot);
  ArmRuns runs = Recorded(20.0, 3);
  ArmFit fit = arm.Fit(runs, robot, Options());
  const std::vector options(4, Options());
  arm.AddRigidTorque(fit, options, robot, &runs);
  const auto rows = [&](std::size_t j) {
    return identify::Design(identify::MakeStates(runs[j], robot.joints[j], Options()), Options());
  };
  const identify::Design before = rows(2);
  const Eigen::MatrixXd columns = before.RigidColumns();
  ASSERT_EQ(columns.cols(), static_cast<Eigen::Index>(fit.base.size()));
  // Bodies that change along a direction change the torque by its column.
  const Eigen::Index direction = columns.cols() - 1;
  const Eigen::VectorXd change = fit.by_others[2].directions.col(direction);
  for (std::size_t i = 0; i < arm.base().independent.size(); ++i) {
    fit.phi[arm.base().independent[i]] += change[static_cast<Eigen::Index>(i)];
  }
  arm.AddRigidTorque(fit, options, robot, &runs);
  const auto torque = [](const identify::Design& design) {
    return design.Column([](const effects::JointSample& x) { return x.rigid_torque_Nm; });
  };
  const Eigen::VectorXd difference = torque(rows(2)) - torque(before);
  EXPECT_GT(difference.norm(), 0.0);
  EXPECT_LT((difference - columns.col(direction)).norm(), 1e-9 * difference.norm());
}

Chain Loaded() {
  Chain chain = Revolute(1.0);
  AddPointMass(0.6, {0.05, -0.02, 0.15}, &chain.bodies.back());
  return chain;
}

ArmLoop WithLoads(const Arm& arm, const actuator::RobotModel& robot, ArmRuns* train,
                  ArmRuns* held_out) {
  ArmLoop loop = FitArm(arm, robot, Options(), train, held_out);
  loop.load = AbsorbedLoad(arm, loop.before);
  loop.held_out_load = LoadHeldOut(arm, robot, loop, *held_out);
  return loop;
}

TEST(ArmLoad, AMassThatTheRefitAbsorbedIsNamedWithItsLink) {
  const actuator::RobotModel robot = Model(0.1, 0.1);
  ArmRuns train = Recorded(40.0, 1, Loaded()), held_out = Recorded(40.0, 2, Loaded());
  const Arm arm(Revolute(1.0), robot);
  const ArmLoop loop = WithLoads(arm, robot, &train, &held_out);
  ASSERT_TRUE(loop.load);
  EXPECT_EQ(loop.load->link, "last_link");
  EXPECT_NEAR(loop.load->mass_kg, 0.6, std::max(0.03, loop.load->half_width_95));
  EXPECT_LT((loop.load->position_m - Eigen::Vector3d(0.05, -0.02, 0.15)).norm(), 0.02);
  EXPECT_GT(loop.load->share, 0.9);
  EXPECT_FALSE(loop.held_out_load) << "both have it";
}

TEST(ArmLoad, AMassOfTheHeldOutRecordingsAloneIsReported) {
  const actuator::RobotModel robot = Model(0.1, 0.1);
  ArmRuns train = Recorded(40.0, 1), held_out = Recorded(40.0, 2, Loaded());
  const Arm arm(Revolute(1.0), robot);
  const ArmLoop loop = WithLoads(arm, robot, &train, &held_out);
  EXPECT_FALSE(loop.load) << loop.load->link << ' ' << loop.load->mass_kg;
  ASSERT_TRUE(loop.held_out_load);
  EXPECT_EQ(loop.held_out_load->link, "last_link");
  EXPECT_NEAR(loop.held_out_load->mass_kg, 0.6, std::max(0.03, loop.held_out_load->half_width_95));
}

TEST(ArmLoad, BodiesThatAreWrongAllOverAreNoMass) {
  const actuator::RobotModel robot = Model(0.1, 0.1);
  ArmRuns train = Recorded(40.0, 1), held_out = Recorded(40.0, 2);
  Chain wrong = Revolute(1.0);
  for (std::size_t b = 0; b < wrong.bodies.size(); ++b) {
    wrong.bodies[b].com_m += 0.05 * Eigen::Vector3d::Unit(static_cast<Eigen::Index>(b % 3));
    wrong.bodies[b].mass_kg *= b % 2 == 0 ? 0.7 : 1.3;
  }
  const Arm arm(wrong, robot);
  const ArmLoop loop = WithLoads(arm, robot, &train, &held_out);
  EXPECT_FALSE(loop.load) << loop.load->link << ' ' << loop.load->mass_kg << ' '
                          << loop.load->share;
  EXPECT_FALSE(loop.held_out_load);
}

TEST(ArmFit, JointsThatTheUrdfLacksAreNamed) {
  actuator::RobotModel robot = Model(0.1, 0.1);
  robot.joints[2].name = "elbow";
  try {
    const Arm arm(Revolute(1.0), robot);
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find("'elbow'"), std::string::npos) << error.what();
    EXPECT_NE(std::string(error.what()).find("one, two, slide, last"), std::string::npos);
  }
}

TEST(ArmError, IsPooledByTheRowsOfTheRecordings) {
  const ArmError a{{1.0, 2.0}, {10.0, 20.0}, 15.0, 1.0};
  const ArmError b{{3.0, 2.0}, {30.0, 20.0}, 25.0, 3.0};
  const ArmError pooled = Pooled({a, b}, {300.0, 100.0});
  EXPECT_DOUBLE_EQ(pooled.rms_Nm[0], std::sqrt(0.75 * 1.0 + 0.25 * 9.0));
  EXPECT_DOUBLE_EQ(pooled.rms_Nm[1], 2.0);
  EXPECT_DOUBLE_EQ(pooled.relative_percent[0], std::sqrt(0.75 * 100.0 + 0.25 * 900.0));
  EXPECT_DOUBLE_EQ(pooled.nrms_percent, std::sqrt(3.0));
  EXPECT_THROW(Pooled({a}, {1.0, 2.0}), std::invalid_argument);
  EXPECT_THROW(Pooled({}, {}), std::invalid_argument);
}

}  // namespace
}  // namespace sinew::arm
