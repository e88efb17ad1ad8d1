// The search of gains, and trials that end with a fall, on a plant written for these tests.
#include "tools/tune_pid/search.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <stdexcept>
#include <vector>

#include "components/robot/reference/trajectory.h"
#include "tools/tune_pid/closed_loop.h"

namespace sinew::tune {
namespace {

// Two joints in each of which a motor torque turns 1 kg m^2 against 6 Nm of weight; the base sinks
// by 1 m a rad of the first joint's sag.
class SaggingRobot final : public provider::SimulatedPlant {
 public:
  static constexpr int kJoints = 2;
  static constexpr double kStanding_m = 0.8, kWeight_Nm = 6.0, kInertia_kg_m2 = 1.0;

  int joint_count() const override { return kJoints; }
  std::uint32_t measured_flags() const override { return 0; }
  void Reset(provider::PlantSensors* sensors) override {
    position_rad_ = velocity_rad_s_ = {};
    Read(sensors);
  }
  void Step(const provider::PlantCommand& command, double period_s,
            provider::PlantSensors* sensors) override {
    for (std::size_t j = 0; j < kJoints; ++j) {
      velocity_rad_s_[j] += period_s * (command.motor_torque_Nm[j] - kWeight_Nm) / kInertia_kg_m2;
      position_rad_[j] += period_s * velocity_rad_s_[j];
    }
    Read(sensors);
  }
  void Disturb(const provider::Disturbance& /*disturbance*/) override {}
  void ImposePressure(const provider::ImposedPressure& /*pressure*/) override {}
  const provider::GearTruth& gear_truth() const override { return gears_; }
  const provider::BodyTruth* body_truth() const override { return &body_; }

 private:
  void Read(provider::PlantSensors* sensors) {
    for (std::size_t j = 0; j < kJoints; ++j) {
      sensors->position_rad[j] = position_rad_[j];
      sensors->velocity_rad_s[j] = velocity_rad_s_[j];
      sensors->valid[j] = true;
    }
    body_.position_m[2] = kStanding_m + position_rad_[0];
  }

  types::JointArray<double> position_rad_{}, velocity_rad_s_{};
  provider::GearTruth gears_;
  provider::BodyTruth body_;
};

constexpr double kDuration_s = 3.0;

ClosedLoopConfig Hold(const control::PidConfig& pid) {
  ClosedLoopConfig config;
  reference::GeneratorConfig still;
  still.trajectory = std::make_shared<reference::Hold>(0.0, kDuration_s);
  still.soft_start_s = 0.0;
  control::JointControlConfig joint;
  joint.pid = pid;
  joint.motor_torque_limit_Nm = 1000.0;
  for (int j = 0; j < SaggingRobot::kJoints; ++j) {
    config.reference.joints.push_back(still);
    config.control.push_back(joint);
  }
  config.duration_s = kDuration_s;
  return config;
}

control::PidConfig Pd(double proportional_Nm_rad, double derivative_Nm_s_rad) {
  return {.proportional_Nm_rad = proportional_Nm_rad, .derivative_Nm_s_rad = derivative_Nm_s_rad};
}

ClosedLoopScore RunWithFalls(const control::PidConfig& pid) {
  SaggingRobot robot;
  ClosedLoopConfig config = Hold(pid);
  config.fallen = [&robot] { return HasFallen(robot, {.least_height_m = 0.5}); };
  return RunClosedLoop(config, robot);
}

TEST(ClosedLoop, AFallEndsTheRun) {
  // 6 Nm / 10 Nm/rad: it sags by 0.6 m, below 0.5 m.
  const ClosedLoopScore fell = RunWithFalls(Pd(10.0, 8.0));
  ASSERT_TRUE(fell.fell_at_s.has_value());
  EXPECT_LT(*fell.fell_at_s, kDuration_s);
  EXPECT_GT(*fell.fell_at_s, 0.2);
  EXPECT_LT(fell.worst_rad, 0.31) << "ticks after the fall do not count";
  EXPECT_EQ(TrackingCost(fell), kDiscarded);
  const ClosedLoopScore stands = RunWithFalls(Pd(60.0, 16.0));
  EXPECT_FALSE(stands.fell_at_s.has_value());
  EXPECT_EQ(TrackingCost(stands), stands.mse_rad2);
}

// At rest each joint sags by weight / gain.
TEST(ClosedLoop, ScoresTheJointsThatAreNamed) {
  SaggingRobot robot;
  ClosedLoopConfig config = Hold(Pd(30.0, 20.0));
  config.control[1].pid = Pd(60.0, 20.0);
  config.score_from_s = kDuration_s - 0.1;
  const double first = std::pow(SaggingRobot::kWeight_Nm / 30.0, 2);
  const double second = std::pow(SaggingRobot::kWeight_Nm / 60.0, 2);
  constexpr double kSettled = 1e-3;  // relative; the slowest pole has 1.6 1/s over 2.9 s
  const auto mse = [&](const std::vector<int>& joints) {
    config.scored_joints = joints;
    return RunClosedLoop(config, robot).mse_rad2;
  };
  EXPECT_NEAR(mse({0}), first, 30.0 * kSettled * first);
  EXPECT_NEAR(mse({1}), second, kSettled * second);
  EXPECT_NEAR(mse({0, 1}), 0.5 * (mse({0}) + mse({1})), 1e-12);
  EXPECT_THROW(mse({}), std::invalid_argument);
  EXPECT_THROW(mse({2}), std::invalid_argument);
}

TEST(ClosedLoop, ARobotOnAFixedBaseDoesNotFall) {
  class FixedRobot : public provider::SimulatedPlant {
   public:
    int joint_count() const override { return 0; }
    std::uint32_t measured_flags() const override { return 0; }
    void Reset(provider::PlantSensors* /*sensors*/) override {}
    void Step(const provider::PlantCommand& /*command*/, double /*period_s*/,
              provider::PlantSensors* /*sensors*/) override {}
    void Disturb(const provider::Disturbance& /*disturbance*/) override {}
    void ImposePressure(const provider::ImposedPressure& /*pressure*/) override {}
    const provider::GearTruth& gear_truth() const override { return gears_; }

   private:
    provider::GearTruth gears_;
  };
  EXPECT_FALSE(HasFallen(FixedRobot(), {.least_height_m = 0.5, .most_tilt_rad = 0.1}));
}

// A bowl in the logarithms of the gains, with its bottom at 20, 2, 0.5.
double Bowl(const control::PidConfig& pid) {
  return std::pow(std::log(pid.proportional_Nm_rad / 20.0), 2) +
         std::pow(std::log(pid.integral_Nm_rad_s / 2.0), 2) +
         std::pow(std::log(pid.derivative_Nm_s_rad / 0.5), 2);
}

TEST(SearchGains, TheSecondStageRefinesTheFirst) {
  SearchConfig config;
  config.trials = 200;
  std::vector<Draw> seen;
  const auto found = SearchGains(
      config, {.derivative_filter_Hz = 20.0}, [](const auto& pid, double) { return Bowl(pid); },
      [&seen](const Draw& draw) { seen.push_back(draw); });
  ASSERT_TRUE(found.has_value());
  EXPECT_EQ(found->cost, Bowl(found->pid));
  EXPECT_EQ(found->stage, 2);
  EXPECT_EQ(found->pid.derivative_filter_Hz, 20.0) << "the rest stays";
  ASSERT_GT(seen.size(), 2u);
  for (std::size_t i = 1; i < seen.size(); ++i) EXPECT_LT(seen[i].cost, seen[i - 1].cost);
  EXPECT_EQ(seen.back().cost, found->cost);
  // 200 draws in a cube of 0.69 wide logarithms about a point that is near: a tenth in each.
  EXPECT_LT(found->cost, 3.0 * 0.1 * 0.1);
}

TEST(SearchGains, DiscardedGainsAreNeverTheBest) {
  SearchConfig config;
  config.trials = 100;
  const auto falls_below_30 = [](const control::PidConfig& pid, double) {
    return pid.proportional_Nm_rad < 30.0 ? kDiscarded : Bowl(pid);
  };
  const auto found = SearchGains(config, {}, falls_below_30);
  ASSERT_TRUE(found.has_value());
  EXPECT_GE(found->pid.proportional_Nm_rad, 30.0);
  EXPECT_FALSE(SearchGains(config, {}, [](const auto&, double) { return kDiscarded; }).has_value());
  EXPECT_FALSE(SearchGains(config, {}, [](const auto&, double) { return NAN; }).has_value());
}

TEST(SearchGains, OneSeedGivesTheSameDrawsWhateverTheCosts) {
  SearchConfig config;
  config.trials = 10;
  const auto draws = [&config](double scale) {
    std::vector<double> out;
    (void)SearchGains(config, {}, [&](const control::PidConfig& pid, double) {
      if (out.size() < 30) {  // those of stage 1
        out.insert(out.end(),
                   {pid.proportional_Nm_rad, pid.integral_Nm_rad_s, pid.derivative_Nm_s_rad});
      }
      return scale * Bowl(pid);
    });
    return out;
  };
  EXPECT_EQ(draws(1.0), draws(-1.0));
  const std::vector<double> first = draws(1.0);
  config.seed = 2;
  EXPECT_NE(first, draws(1.0));
}

// With a robot that falls under weak gains: the gains found hold it up.
TEST(SearchGains, FindsGainsWithWhichTheRobotStands) {
  SearchConfig config;
  config.trials = 30;
  int fallen = 0;
  const auto found = SearchGains(config, {}, [&fallen](const control::PidConfig& pid, double) {
    const ClosedLoopScore score = RunWithFalls(pid);
    fallen += score.fell_at_s ? 1 : 0;
    return TrackingCost(score);
  });
  ASSERT_TRUE(found.has_value());
  EXPECT_GT(fallen, 5);
  EXPECT_FALSE(RunWithFalls(found->pid).fell_at_s.has_value());
  EXPECT_GT(found->pid.proportional_Nm_rad, 20.0);
}

TEST(SearchGains, RefusesWhatIsNoSearch) {
  const auto zero = [](const auto&, double) { return 0.0; };
  SearchConfig bad;
  bad.trials = 0;
  EXPECT_THROW((void)SearchGains(bad, {}, zero), std::invalid_argument);
  bad = {};
  bad.integral = {2.0, 1.0};
  EXPECT_THROW((void)SearchGains(bad, {}, zero), std::invalid_argument);
  bad = {};
  bad.around_best.lower = 0.0;
  EXPECT_THROW((void)SearchGains(bad, {}, zero), std::invalid_argument);
}

}  // namespace
}  // namespace sinew::tune
