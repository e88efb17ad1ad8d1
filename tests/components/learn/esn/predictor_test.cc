#include "components/learn/esn/predictor.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "components/base/types/regime.h"
#include "tests/support/allocations.h"

namespace sinew::esn {
namespace {

// A readout that is zero but for its constant: the prediction says which network it is.
Weights Constant(double torque_Nm, std::vector<Input> inputs = {{Signal::kReferencePosition, 0}},
                 int outputs = 1) {
  Hyperparameters hyper;
  hyper.neurons = 20;
  Weights weights = MakeWeights(hyper, static_cast<int>(inputs.size()), outputs);
  weights.inputs = std::move(inputs);
  weights.target = "drive_torque_Nm";
  weights.period_s = 1.0 / 240.0;
  weights.readout.col(0).setConstant(torque_Nm);
  return weights;
}

Frame At(double position_rad) {
  Frame frame;
  frame.Set(Signal::kReferencePosition, 0, position_rad);
  return frame;
}

TEST(Predictor, TheRegimeChoosesTheNetworkAndNobodyGuesses) {
  Predictor predictor(Constant(1.5), Constant(-2.5));
  EXPECT_TRUE(predictor.needs_regime());
  Prediction p = predictor.Step(At(0.1), types::Regime::kSea);
  EXPECT_TRUE(p.valid[0]);
  EXPECT_EQ(p.torque_Nm[0], 1.5);
  EXPECT_EQ(p.chosen, Which::kSea);
  p = predictor.Step(At(0.1), types::Regime::kPea);
  EXPECT_TRUE(p.valid[0]);
  EXPECT_EQ(p.torque_Nm[0], -2.5);
  EXPECT_EQ(p.chosen, Which::kPea);
  p = predictor.Step(At(0.1), types::Regime::kUnknown);
  EXPECT_FALSE(p.valid[0]);
  EXPECT_EQ(p.torque_Nm[0], 0.0);
  EXPECT_FALSE(p.chosen.has_value());
  // The prediction of each network is there all the same.
  EXPECT_EQ(p.sea_torque_Nm[0], 1.5);
  EXPECT_EQ(p.pea_torque_Nm[0], -2.5);
}

// A robot that begins at rest is not moved by a reservoir that runs in.
TEST(Predictor, TheFirstInputSettlesTheNetwork) {
  Weights weights = Constant(0.0);
  weights.readout.setConstant(0.3);
  Predictor predictor({}, weights);
  const double first = predictor.Step(At(0.4), types::Regime::kUnknown).torque_Nm[0];
  EXPECT_NEAR(predictor.Step(At(0.4), types::Regime::kUnknown).torque_Nm[0], first, 1e-7);
  EXPECT_GT(std::abs(predictor.Step(At(-0.4), types::Regime::kUnknown).torque_Nm[0] - first), 1e-3);
  predictor.Reset();
  EXPECT_NEAR(predictor.Step(At(0.4), types::Regime::kUnknown).torque_Nm[0], first, 1e-12);
}

TEST(Predictor, OneNetworkCountsInEveryRegime) {
  Predictor predictor(std::nullopt, Constant(-2.5));
  EXPECT_FALSE(predictor.needs_regime());
  for (const types::Regime regime :
       {types::Regime::kUnknown, types::Regime::kSea, types::Regime::kPea}) {
    const Prediction p = predictor.Step(At(0.1), regime);
    EXPECT_TRUE(p.valid[0]);
    EXPECT_EQ(p.torque_Nm[0], -2.5);
    EXPECT_EQ(p.sea_torque_Nm[0], -2.5);
    EXPECT_EQ(p.pea_torque_Nm[0], -2.5);
    EXPECT_EQ(p.chosen, Which::kPea);
  }
}

TEST(Predictor, BothNetworksRunInWhicheverCounts) {
  Predictor switched(Constant(1.0), Constant(2.0));
  Predictor steady(Constant(1.0), Constant(2.0));
  for (int t = 0; t < 50; ++t) {
    switched.Step(At(0.01 * t), t % 2 == 0 ? types::Regime::kSea : types::Regime::kPea);
    steady.Step(At(0.01 * t), types::Regime::kPea);
  }
  EXPECT_EQ(Eigen::VectorXd(switched.network(Which::kSea).state()),
            steady.network(Which::kSea).state());
  EXPECT_EQ(Eigen::VectorXd(switched.network(Which::kPea).state()),
            steady.network(Which::kPea).state());
  EXPECT_GT(steady.network(Which::kSea).state().norm(), 0.0);
}

TEST(Predictor, ANetworkThatLacksAnInputHasNoPrediction) {
  Predictor predictor(Constant(1.0, {{Signal::kPlayAngle, 0}}), Constant(2.0));
  Prediction p = predictor.Step(At(0.1), types::Regime::kSea);
  EXPECT_FALSE(p.valid[0]);
  EXPECT_FALSE(p.chosen.has_value());
  EXPECT_EQ(p.torque_Nm[0], 0.0);
  p = predictor.Step(At(0.1), types::Regime::kPea);
  EXPECT_TRUE(p.valid[0]);
  Frame frame = At(0.1);
  frame.Set(Signal::kPlayAngle, 0, 0.02);
  EXPECT_TRUE(predictor.Step(frame, types::Regime::kSea).valid[0]);
  EXPECT_FALSE(predictor.Step(At(std::nan("")), types::Regime::kPea).valid[0]);
}

TEST(Predictor, TakesAdaptedReadoutsByVersion) {
  Predictor predictor(std::nullopt, Constant(2.0));
  Eigen::MatrixXd readout = predictor.network(Which::kPea).readout();
  readout(0, 0) = 3.0;
  EXPECT_EQ(predictor.readout_version(Which::kPea), 0u);
  EXPECT_TRUE(predictor.SetReadout(Which::kPea, 17, readout));
  EXPECT_EQ(predictor.Step(At(0.0), types::Regime::kUnknown).torque_Nm[0], 3.0);
  EXPECT_EQ(predictor.readout_version(Which::kPea), 17u);
  EXPECT_FALSE(predictor.SetReadout(Which::kSea, 18, readout));
  readout(0, 0) = std::nan("");
  EXPECT_FALSE(predictor.SetReadout(Which::kPea, 19, readout));
  EXPECT_EQ(predictor.readout_version(Which::kPea), 17u);
}

TEST(Predictor, OneNetworkMayServeSeveralJoints) {
  std::vector<Input> inputs;
  for (int joint = 0; joint < 6; ++joint) inputs.push_back({Signal::kReferencePosition, joint});
  Predictor predictor(std::nullopt, Constant(4.0, inputs, 6));
  Frame frame;
  for (int joint = 0; joint < 6; ++joint) frame.Set(Signal::kReferencePosition, joint, 0.1 * joint);
  const Prediction p = predictor.Step(frame, types::Regime::kUnknown);
  EXPECT_EQ(p.joint_count, 6);
  for (std::size_t j = 0; j < 6; ++j) EXPECT_TRUE(p.valid[j] && p.torque_Nm[j] == 4.0);
  EXPECT_FALSE(p.valid[6]);
}

TEST(Predictor, RefusesNetworksThatDoNotGoTogether) {
  EXPECT_THROW(Predictor(std::nullopt, std::nullopt), std::invalid_argument);
  Weights other = Constant(1.0);
  other.period_s = 0.01;
  EXPECT_THROW(Predictor(Constant(1.0), other), std::invalid_argument);
  EXPECT_THROW(Predictor(Constant(1.0), Constant(1.0, {{Signal::kReferencePosition, 0}}, 2)),
               std::invalid_argument);
  other = Constant(1.0);
  other.inputs.clear();
  EXPECT_THROW(Predictor(std::nullopt, other), std::invalid_argument);
  other = Constant(1.0);
  other.target = "load_torque_Nm";
  EXPECT_THROW(Predictor(other, std::nullopt), std::invalid_argument);
}

TEST(Predictor, StepTakesNoMemory) {
  Predictor predictor(Constant(1.0), Constant(2.0));
  const Frame frame = At(0.1);
  bool good = true;
  const long before = test::Allocations();
  for (int t = 0; t < 100; ++t) good = good && predictor.Step(frame, types::Regime::kPea).valid[0];
  const long taken = test::Allocations() - before;
  EXPECT_EQ(taken, 0);
  EXPECT_TRUE(good);
}

}  // namespace
}  // namespace sinew::esn
