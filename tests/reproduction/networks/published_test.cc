#include "reproduction/networks/published.h"

#include <gtest/gtest.h>

#include "reproduction/networks/model.h"

namespace sinew::networks {
namespace {

const PublishedModel& Named(const std::vector<PublishedModel>& models, const std::string& name) {
  for (const PublishedModel& model : models) {
    if (model.name == name) return model;
  }
  throw std::invalid_argument(name);
}

TEST(Published, EveryCountOfTable62IsThatOfTheWeights) {
  EXPECT_EQ(CountParameters(Named(Table62(), "LSTM")), 571);
  EXPECT_EQ(CountParameters(Named(Table62(), "GRU")), 540);
  EXPECT_EQ(CountParameters(Named(Table62(), "FFNN")), 589);
  EXPECT_EQ(CountParameters(Named(Table62(), "NNX")), 541);
  EXPECT_EQ(CountParameters(Named(Table62(), "ESN")), 470);
}

TEST(Published, EveryCountOfTable64IsThatOfTheWeights) {
  EXPECT_EQ(CountParameters(Named(Table64(), "Pure linear")), 3);
  EXPECT_EQ(CountParameters(Named(Table64(), "Pure LSTM")), 75);
  EXPECT_EQ(CountParameters(Named(Table64(), "Pure ESN")), 78);
  EXPECT_EQ(CountParameters(Named(Table64(), "Wiener LSTM")), 86);
  EXPECT_EQ(CountParameters(Named(Table64(), "Wiener FFNN")), 84);
  EXPECT_EQ(CountParameters(Named(Table64(), "Wiener FFNN big")), 128);
  EXPECT_EQ(CountParameters(Named(Table64(), "Wiener ESN")), 81);
}

TEST(Published, EveryCountOfTable65IsThatOfTheWeights) {
  EXPECT_EQ(CountParameters(Named(Table65(), "LSTM")), 912);
  EXPECT_EQ(CountParameters(Named(Table65(), "FFNN")), 911);
  EXPECT_EQ(CountParameters(Named(Table65(), "NNX")), 911);
  EXPECT_EQ(CountParameters(Named(Table65(), "ESN")), 912);
}

TEST(Published, TheTextsTenUnitsOfTheGruHave461ParametersWithTwoBiases) {
  const Architecture ten{.kind = Kind::kGru, .inputs = 3, .memory = 10, .hidden = {10}};
  EXPECT_EQ(ten.ParameterCount(), 461);
}

TEST(Published, TheCountOf65HoldsOnlyFor36InputsAnd12Outputs) {
  // What the text says, 18 inputs and 6 outputs, has about half of them.
  EXPECT_EQ(CountParameters(Table65(6)[0]), 4 * (5 * (18 + 5) + 5) + 5 * 6 + 6);
  // (6.15) with the hidden layers it prints, 4-6-7, has other terms than its own sum.
  const Architecture printed{.inputs = 36, .outputs = 12, .memory = 5, .hidden = {4, 6, 7}};
  EXPECT_EQ(printed.ParameterCount(), 724 + 30 + 49 + 96);
}

// What is fitted has the printed number of parameters: the same count, from the weights.
TEST(Published, WhatIsFittedHasTheSameNumber) {
  Samples samples;
  samples.inputs = Eigen::MatrixXd::Zero(6, 120);
  samples.targets = Eigen::MatrixXd::Zero(1, 120);
  for (int t = 0; t < 120; ++t) {
    for (int m = 0; m < 6; ++m) samples.inputs(m, t) = std::sin(0.1 * t * (m + 1));
    samples.targets(0, t) = samples.inputs(0, t) * samples.inputs(1, t);
    samples.first.push_back(0);
    samples.train.push_back(t);
  }
  samples.input = {Eigen::VectorXd::Zero(6), Eigen::VectorXd::Ones(6)};
  samples.output = {Eigen::VectorXd::Zero(1), Eigen::VectorXd::Ones(1)};
  for (PublishedModel plan : Table64()) {
    plan.training.epochs = 1;
    const FitResult result = Fit(plan, samples, {4, 1, 3}, 1);
    EXPECT_EQ(result.model.parameter_count(), plan.published_parameters) << plan.name;
    EXPECT_EQ(result.model.parameter_count(), CountParameters(plan)) << plan.name;
  }
}

}  // namespace
}  // namespace sinew::networks
