#include "components/learn/esn/dataset/dataset.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <stdexcept>

#include "components/base/config/config.h"
#include "components/learn/esn/dataset/file/training_file.h"
#include "components/learn/esn/normal.h"
#include "components/model/effects/effect.h"
#include "tests/support/temporary_folder.h"

namespace sinew::esn {
namespace {

using Measured = types::Signal;

constexpr double kBacklash_rad = 0.0464;

actuator::JointModel RigModel() {
  actuator::JointModel model;
  model.name = "rig";
  model.constants = {100.0, 0.3, 9.81, 0.0159155, 0.0};
  model.backlash_rad = kBacklash_rad;
  actuator::Term drive;
  drive.effect = effects::MakeEffect("drive_current", model.constants);
  drive.linear.resize(1);
  drive.linear[0].value = 0.77;
  model.terms.push_back(drive);
  return model;
}

constexpr double kTorquePerAmpere = 0.77 * 100.0 * 0.0159155;

// A motion of three sines below 2 Hz; what drives it is a rigid link with gravity, viscous and
// smoothed dry friction and a pressure that swings. The play is crossed with the sign of the
// torque.
struct Motion {
  double q, v, a, pressure, torque;
};
Motion At(double t) {
  Motion m{};
  const double amplitude[] = {0.3, 0.1, 0.05};
  const double frequency_Hz[] = {0.37, 0.91, 1.7};
  for (int i = 0; i < 3; ++i) {
    const double w = 2.0 * std::numbers::pi * frequency_Hz[i];
    m.q += amplitude[i] * std::sin(w * t + i);
    m.v += amplitude[i] * w * std::cos(w * t + i);
    m.a -= amplitude[i] * w * w * std::sin(w * t + i);
  }
  m.pressure = 3.0 + std::sin(0.8 * t);
  m.torque = 0.13 * m.a + 0.31 * m.v + 0.22 * std::tanh(m.v / 0.1) + 0.58 * std::cos(m.q) -
             0.36 * m.pressure + 3.9 * m.pressure * (m.q - 0.15);
  return m;
}

// Sampled at rate_Hz; the motor leads by the play to the side that the torque pushes.
types::Run Record(double seconds, double rate_Hz, double noise, double centre_rad = 0.0) {
  NormalGenerator random(4);
  const Eigen::Index count = static_cast<Eigen::Index>(seconds * rate_Hz);
  types::Run run;
  run.name = "synthetic";
  run.time_s.resize(count);
  Eigen::VectorXd q(count), motor(count), current(count), pressure(count), force(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const double t = static_cast<double>(i) / rate_Hz;
    const Motion m = At(t);
    run.time_s(i) = t;
    q(i) = m.q + noise * 1e-4 * random.Next();
    const double side =
        std::clamp(m.torque / 0.3, -1.0, 1.0);  // inside the play while the torque is small
    motor(i) = 100.0 * (m.q + centre_rad + 0.5 * kBacklash_rad * side);
    current(i) = m.torque / kTorquePerAmpere + noise * 0.03 * random.Next();
    pressure(i) = m.pressure;
    force(i) = 2.0 * std::sin(t);
  }
  run.signals[Measured::kPosition] = q;
  run.signals[Measured::kMotorPosition] = motor;
  run.signals[Measured::kMotorCurrent] = current;
  run.signals[Measured::kChamberPressure] = pressure;
  run.signals[Measured::kLoadForce] = force;
  run.signals[Measured::kPayload] = Eigen::VectorXd::Zero(count);
  return run;
}

DatasetConfig Config(Region region) {
  DatasetConfig config;
  config.inputs = {Signal::kReferencePosition, Signal::kReferenceVelocity,
                   Signal::kReferenceAcceleration, Signal::kChamberPressure, Signal::kPlayAngle};
  config.region = region;
  return config;
}

DatasetConfig RobotConfig() {
  DatasetConfig config;
  config.inputs = {Signal::kReferencePosition, Signal::kReferenceVelocity};
  return config;
}

TEST(RobotDataset, JointsStandSideBySide) {
  const std::vector<types::Run> first = {Record(20.0, 240.0, 0.0)};
  std::vector<types::Run> second = first;
  second[0].signals[Measured::kPosition] *= 2.0;
  second[0].signals[Measured::kMotorCurrent] *= -1.0;
  const Dataset robot = MakeRobotDataset({first, second}, {RigModel(), RigModel()}, RobotConfig());
  const Sequence& both = robot.sequences.at(0);
  const Sequence one = MakeDataset(first, RigModel(), RobotConfig()).sequences.at(0);
  const Sequence two = MakeDataset(second, RigModel(), RobotConfig()).sequences.at(0);
  ASSERT_EQ(both.inputs.cols(), 4);
  ASSERT_EQ(both.targets.cols(), 2);
  EXPECT_EQ(both.inputs.leftCols(2), one.inputs);
  EXPECT_EQ(both.inputs.rightCols(2), two.inputs);
  EXPECT_EQ(both.targets.col(0), one.targets.col(0));
  EXPECT_EQ(both.targets.col(1), two.targets.col(0));
  EXPECT_EQ(both.use, one.use);
  EXPECT_EQ(InputsOfRobot(RobotConfig().inputs, 2),
            (std::vector<Input>{{Signal::kReferencePosition, 0},
                                {Signal::kReferenceVelocity, 0},
                                {Signal::kReferencePosition, 1},
                                {Signal::kReferenceVelocity, 1}}));
}

TEST(RobotDataset, WhatDoesNotFitIsNamed) {
  const std::vector<types::Run> run = {Record(20.0, 240.0, 0.0)};
  const auto what = [](const auto& make) -> std::string {
    try {
      make();
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "";
  };
  const std::vector<actuator::JointModel> models = {RigModel(), RigModel()};
  EXPECT_THAT(what([&] { MakeRobotDataset({run}, models, RobotConfig()); }),
              ::testing::HasSubstr("1 joints, expected those of the model's 2"));
  EXPECT_THAT(what([&] {
                MakeRobotDataset({run, {Record(10.0, 240.0, 0.0)}}, models, RobotConfig());
              }),
              ::testing::HasSubstr("other lengths"));
  DatasetConfig outside = RobotConfig();
  outside.region = Region::kOutside;
  EXPECT_THAT(what([&] {
                MakeRobotDataset({run, run}, models, outside);
              }),
              ::testing::HasSubstr("region 'all'"));
}

TEST(Dataset, InputsAreTheMotionAndItsDerivativesAndTheTargetIsTheDriveTorque) {
  for (const double rate_Hz : {240.0, 80.0, 1000.0}) {
    const Dataset data =
        MakeDataset({Record(20.0, rate_Hz, 0.0)}, RigModel(), Config(Region::kAll));
    ASSERT_EQ(data.sequences.size(), 1u);
    const Sequence& s = data.sequences[0];
    EXPECT_NEAR(static_cast<double>(s.inputs.rows()), 20.0 * 240.0, 4.0);
    double worst[5] = {};
    for (Eigen::Index t = 240; t + 240 < s.inputs.rows(); ++t) {
      const Motion m = At(static_cast<double>(t) / 240.0);
      worst[0] = std::max(worst[0], std::abs(s.inputs(t, 0) - m.q));
      worst[1] = std::max(worst[1], std::abs(s.inputs(t, 1) - m.v));
      worst[2] = std::max(worst[2], std::abs(s.inputs(t, 2) - m.a));
      worst[3] = std::max(worst[3], std::abs(s.inputs(t, 3) - m.pressure));
      worst[4] = std::max(worst[4], std::abs(s.targets(t, 0) - m.torque));
    }
    // The filter (order 4 at 12 Hz, twice) keeps all but (1.7 / 12)^8 = 2e-7 of the fastest sine;
    // what is left are the ends' transients and, at 80 Hz, the spline.
    EXPECT_LT(worst[0], 1e-4) << rate_Hz;
    EXPECT_LT(worst[1], 1e-3) << rate_Hz;
    EXPECT_LT(worst[2], 1e-2) << rate_Hz;
    EXPECT_LT(worst[3], 1e-4) << rate_Hz;
    // Dry friction turns within 0.1 rad/s: a spline through 80 Hz rounds its corners.
    EXPECT_LT(worst[4], rate_Hz < 100.0 ? 0.05 : 1e-3) << rate_Hz;
  }
}

TEST(Dataset, SamplesInsideAndOutsideThePlayShareTheRecording) {
  const std::vector<types::Run> runs = {Record(20.0, 240.0, 0.0)};
  const Dataset inside = MakeDataset(runs, RigModel(), Config(Region::kInside));
  const Dataset outside = MakeDataset(runs, RigModel(), Config(Region::kOutside));
  EXPECT_GT(inside.inside, 100);
  EXPECT_EQ(inside.inside, outside.inside);
  long used_inside = 0;
  long used_outside = 0;
  long expected_inside = 0;
  for (std::size_t t = 0; t < inside.sequences[0].use.size(); ++t) {
    const bool in = inside.sequences[0].use[t] != Use::kNone;
    const bool out = outside.sequences[0].use[t] != Use::kNone;
    EXPECT_FALSE(in && out) << t;
    used_inside += in;
    used_outside += out;
    const double torque = At(static_cast<double>(t) / 240.0).torque;
    expected_inside += std::abs(torque) < 0.3 * (1.0 - 8e-4 / (0.5 * kBacklash_rad));
  }
  EXPECT_EQ(used_inside, inside.inside);
  EXPECT_EQ(used_inside + used_outside, inside.samples);
  EXPECT_EQ(used_inside, expected_inside);
  // The play angle runs from 0 at the lower contact to the whole backlash at the upper one.
  EXPECT_NEAR(inside.sequences[0].inputs.col(4).minCoeff(), 0.0, 1e-9);
  EXPECT_NEAR(inside.sequences[0].inputs.col(4).maxCoeff(), kBacklash_rad, 1e-9);
}

TEST(Dataset, SamplesNearTheOtherRegionTeachNothingWhenGuarded) {
  const std::vector<types::Run> runs = {Record(20.0, 240.0, 0.0)};
  DatasetConfig config = Config(Region::kOutside);
  const Sequence open = MakeDataset(runs, RigModel(), config).sequences.at(0);
  constexpr int kGuard = 36;
  config.region_guard_s = kGuard / 240.0;
  const Sequence guarded = MakeDataset(runs, RigModel(), config).sequences.at(0);
  const auto count = static_cast<long>(open.use.size());
  long left_out = 0;
  for (long t = 1; t + 1 < count; ++t) {
    bool near_inside = false;
    for (long i = std::max(0L, t - kGuard); i <= std::min(count - 1, t + kGuard); ++i) {
      near_inside = near_inside || open.use[static_cast<std::size_t>(i)] == Use::kNone;
    }
    const auto at = static_cast<std::size_t>(t);
    EXPECT_EQ(guarded.use[at], near_inside ? Use::kNone : open.use[at]) << t;
    left_out += near_inside && open.use[at] != Use::kNone;
  }
  EXPECT_GT(left_out, 100);
}

TEST(Dataset, TheDirectionIsThatOfTheMeasuredMotion) {
  DatasetConfig config = Config(Region::kAll);
  config.inputs = {Signal::kReferenceVelocity, Signal::kReferenceDirection};
  const Dataset data = MakeDataset({Record(10.0, 240.0, 0.0)}, RigModel(), config);
  const Eigen::MatrixXd& inputs = data.sequences.at(0).inputs;
  for (Eigen::Index t = 0; t < inputs.rows(); ++t) {
    EXPECT_EQ(inputs(t, 1), std::tanh(inputs(t, 0) / kDirectionWidth_rad_s));
  }
}

TEST(Dataset, FindsTheCentreOfThePlayWhenAsked) {
  DatasetConfig config = Config(Region::kInside);
  config.play_centre_rad.reset();
  const Dataset shifted = MakeDataset({Record(20.0, 240.0, 0.0, 0.123)}, RigModel(), config);
  EXPECT_NEAR(shifted.play_centre_rad, 0.123, 1e-9);
  EXPECT_EQ(shifted.inside, MakeDataset({Record(20.0, 240.0, 0.0)}, RigModel(), config).inside);
}

TEST(Dataset, SplitsEveryBlockIntoTrainingAndTest) {
  DatasetConfig config = Config(Region::kAll);
  config.blocks = 10;
  config.train_share = 0.7;
  const Dataset data = MakeDataset({Record(20.0, 240.0, 0.0)}, RigModel(), config);
  const std::vector<Use>& use = data.sequences[0].use;
  const double count = static_cast<double>(use.size());
  const auto train = std::count(use.begin(), use.end(), Use::kTrain);
  EXPECT_NEAR(static_cast<double>(train), 0.7 * count, 11.0);
  EXPECT_EQ(train + std::count(use.begin(), use.end(), Use::kTest), static_cast<long>(use.size()));
  long changes = 0;
  for (std::size_t t = 1; t < use.size(); ++t) changes += use[t] != use[t - 1];
  EXPECT_EQ(changes, 19);
  const Dataset test = MakeDataset({Record(20.0, 240.0, 0.0)}, RigModel(), config, true);
  EXPECT_EQ(std::count(test.sequences[0].use.begin(), test.sequences[0].use.end(), Use::kTrain), 0);
}

TEST(Dataset, ANetworkLearnsTheInverseDynamicsOfASyntheticRig) {
  Dataset data = MakeDataset({Record(60.0, 80.0, 1.0)}, RigModel(), Config(Region::kOutside));
  TrainingConfig config;
  const TrainingResult result = Train(data.sequences, config);
  // The target has 2.5 Nm rms, its noise 0.037; the published size leaves 0.12, mostly at the turns
  // of the dry friction. The inputs alone, without a reservoir, leave 0.63.
  EXPECT_LT(std::sqrt(result.test.mse(0)), 0.17);
  EXPECT_LT(result.test.normalised(0), 0.005);
  EXPECT_GT(result.test.samples, 1000);
}

TEST(Dataset, NamesTheSignalThatIsMissing) {
  const auto message = [](auto change) {
    types::Run run = Record(5.0, 240.0, 0.0);
    actuator::JointModel model = RigModel();
    DatasetConfig config = Config(Region::kOutside);
    change(run, model, config);
    try {
      MakeDataset({run}, model, config);
    } catch (const std::invalid_argument& error) {
      return std::string(error.what());
    }
    return std::string("accepted");
  };
  using R = types::Run;
  using M = actuator::JointModel;
  using C = DatasetConfig;
  EXPECT_EQ(message([](R&, M&, C&) {}), "accepted");
  EXPECT_EQ(message([](R& r, M&, C&) { r.signals.erase(Measured::kChamberPressure); }),
            "synthetic: no signal 'chamber_pressure', which input chamber_pressure_bar needs");
  EXPECT_EQ(message([](R& r, M&, C&) { r.signals.erase(Measured::kMotorCurrent); }),
            "synthetic: no signal 'motor_current', which the target drive_torque_Nm needs");
  EXPECT_EQ(message([](R& r, M&, C& c) {
              c.inputs.pop_back();
              r.signals.erase(Measured::kMotorPosition);
            }),
            "synthetic: no signal 'motor_position', which the play angle is computed from");
  EXPECT_EQ(
      message([](R&, M& m, C&) { m.backlash_rad = 0.0; }),
      "model rig: backlash_rad is 0, but the region of the network is defined by the backlash");
  EXPECT_EQ(message([](R&, M& m, C&) { m.terms.clear(); }),
            "model rig: no drive term, which the target drive_torque_Nm needs");
  EXPECT_EQ(message([](R&, M&, C& c) { c.inputs.clear(); }), "inputs: none, expected at least one");
  EXPECT_EQ(message([](R&, M&, C& c) { c.train_share = 0.0; }),
            "train_share: 0.000000, expected above 0, at most 1");
}

TEST(Dataset, TheLoadTorqueIsForceTimesLength) {
  DatasetConfig config = Config(Region::kAll);
  config.target = Target::kLoadTorque;
  const Dataset data = MakeDataset({Record(5.0, 240.0, 0.0)}, RigModel(), config);
  for (Eigen::Index t = 0; t < data.sequences[0].targets.rows(); t += 37) {
    EXPECT_NEAR(data.sequences[0].targets(t, 0),
                0.3 * 2.0 * std::sin(static_cast<double>(t) / 240.0), 1e-9);
  }
}

constexpr const char* kPlan = R"(schema: sinew-esn-train/1
rate_Hz: 240
networks:
  - name: sea
    target: load_torque_Nm
    region: inside
    inputs: [play_angle_rad, velocity_rad_s, chamber_pressure_bar]
    neurons: 470
    spectral_radius: 1.25
    leak: 0.13
    ridge_beta: 0.01
  - name: pea
    target: drive_torque_Nm
    region: outside
    inputs: [reference_position_rad]
    neurons: 78
    seed: 5
)";

std::string PlanMessage(std::string text, const std::string& what, const std::string& by,
                        const std::string& network = "pea") {
  const std::size_t at = text.find(what);
  EXPECT_NE(at, std::string::npos) << what;
  text.replace(at, what.size(), by);
  const testing::TemporaryFolder folder;
  try {
    LoadNetworkPlan(folder.Write("t.yaml", text), network);
  } catch (const UsageError& error) {
    return std::string(error.what()).substr(folder.path().string().size() + 1);
  }
  return "accepted";
}

TEST(TrainingFile, ReadsThePlanOfANetwork) {
  const testing::TemporaryFolder folder;
  const std::string file = folder.Write("t.yaml", kPlan);
  const NetworkPlan sea = LoadNetworkPlan(file, "sea");
  EXPECT_EQ(sea.dataset.region, Region::kInside);
  EXPECT_EQ(sea.dataset.target, Target::kLoadTorque);
  EXPECT_EQ(sea.training.hyper.neurons, 470);
  EXPECT_EQ(sea.training.hyper.spectral_radius, 1.25);
  EXPECT_EQ(sea.training.ridge_beta, 0.01);
  const NetworkPlan pea = LoadNetworkPlan(file, "pea");
  EXPECT_EQ(pea.dataset.inputs, std::vector<Signal>{Signal::kReferencePosition});
  EXPECT_EQ(pea.training.hyper.seed, 5u);
  EXPECT_FALSE(pea.training.ridge_beta.has_value());
  EXPECT_EQ(pea.dataset.period_s, 1.0 / 240.0);
  EXPECT_EQ(pea.training.period_s, 1.0 / 240.0);
}

TEST(TrainingFile, NamesEveryMistakeWithItsLine) {
  EXPECT_THAT(
      PlanMessage(kPlan, "[reference_position_rad]", "[motor_current_A]"),
      ::testing::StartsWith("t.yaml:15: key 'networks[1].inputs': 'motor_current_A', expected "
                            "reference_position_rad, "));
  EXPECT_THAT(PlanMessage(kPlan, "neurons: 78", "neurons: -3"),
              ::testing::StartsWith("t.yaml:16: "));
  EXPECT_THAT(PlanMessage(kPlan, "seed: 5", "sed: 5"), ::testing::StartsWith("t.yaml:17: "));
  EXPECT_THAT(PlanMessage(kPlan, "leak: 0.13", "leak: .nan", "sea"),
              ::testing::StartsWith("t.yaml:10: "));
  EXPECT_THAT(PlanMessage(kPlan, "leak: 0.13", "shared_rows: 2", "sea"),
              ::testing::AllOf(::testing::StartsWith("t.yaml:10: "),
                               ::testing::HasSubstr("2, expected 1 or 4")));
  EXPECT_THAT(PlanMessage(kPlan, "region: inside", "region: within"),
              ::testing::StartsWith("t.yaml:6: "));
  EXPECT_THAT(PlanMessage(kPlan, "rate_Hz", "rate_hz"), ::testing::HasSubstr("rate_Hz"));
  EXPECT_THAT(PlanMessage(kPlan, "pea", "peas"),
              ::testing::HasSubstr("no network 'pea', expected one of sea, peas"));
}

}  // namespace
}  // namespace sinew::esn
