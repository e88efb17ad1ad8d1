#include "reproduction/networks/model.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <limits>

#include "components/learn/esn/normal.h"
#include "reproduction/networks/stepper.h"
#include "tests/support/allocations.h"

namespace sinew::networks {
namespace {

// Two sequences of a system with memory and a nonlinearity.
std::vector<esn::Sequence> SomeSequences(int inputs, int count, std::uint64_t seed) {
  esn::NormalGenerator random(seed);
  std::vector<esn::Sequence> sequences(2);
  for (esn::Sequence& q : sequences) {
    q.inputs.resize(count, inputs);
    q.targets.resize(count, 1);
    double slow = 0.0;
    for (int t = 0; t < count; ++t) {
      for (int m = 0; m < inputs; ++m) {
        const double before = t == 0 ? 0.0 : q.inputs(t - 1, m);
        q.inputs(t, m) = 0.9 * before + 0.4 * random.Next();
      }
      slow = 0.8 * slow + 0.2 * q.inputs(t, 0);
      q.targets(t, 0) = 3.0 + 2.0 * std::tanh(2.0 * slow) + 0.5 * q.inputs(t, 1);
      q.use.push_back(10 * (t * 10 % count) < 7 * count ? esn::Use::kTrain : esn::Use::kTest);
    }
  }
  return sequences;
}

TEST(Samples, AreNormalisedByTheTrainingSamplesAlone) {
  const Samples samples = MakeSamples(SomeSequences(3, 200, 1));
  double sum = 0.0, squares = 0.0;
  for (const int t : samples.train) {
    sum += samples.targets(0, t);
    squares += samples.targets(0, t) * samples.targets(0, t);
  }
  const double count = static_cast<double>(samples.train.size());
  EXPECT_NEAR(sum / count, 0.0, 1e-12);
  EXPECT_NEAR(squares / count, 1.0, 1e-12);
  EXPECT_EQ(samples.train.size(), 280U);
  EXPECT_EQ(samples.test.size(), 120U);
  EXPECT_EQ(samples.first[199], 0);
  EXPECT_EQ(samples.first[200], 200);
}

TEST(Samples, ValidationIsTheEndOfEveryTrainingPieceWithAGapBefore) {
  const Samples samples = MakeSamples(SomeSequences(2, 200, 1), 0.25, 2);
  // Pieces of 14: 8 teach, 2 are left out, 4 validate.
  ASSERT_EQ(samples.validation.size(), 20U * 4U);
  ASSERT_EQ(samples.train.size(), 20U * 8U);
  EXPECT_EQ(samples.train[7], 7);
  EXPECT_EQ(samples.validation[0], 10);
  EXPECT_EQ(samples.test[0], 14);
}

TEST(Samples, TooFewAreRefused) {
  EXPECT_THROW(MakeSamples(SomeSequences(2, 4, 1)), std::invalid_argument);
  EXPECT_THROW(MakeSamples({}), std::invalid_argument);
  std::vector<esn::Sequence> bad = SomeSequences(2, 50, 1);
  bad[1].targets(3, 0) = std::numeric_limits<double>::infinity();
  EXPECT_THROW(MakeSamples(bad), std::invalid_argument);
}

TEST(LinearModel, FindsTheCoefficientsOfAnImpulseResponse) {
  Samples samples = MakeSamples(SomeSequences(2, 300, 4));
  const double g[] = {0.7, -0.2, 0.1, 0.3};
  for (int t = 0; t < samples.count(); ++t) {
    const int before = std::max(t - 1, samples.first[static_cast<std::size_t>(t)]);
    samples.targets(0, t) = g[0] * samples.inputs(0, t) + g[1] * samples.inputs(1, t) +
                            g[2] * samples.inputs(0, before) + g[3] * samples.inputs(1, before);
  }
  const LinearModel model = FitLinear(samples, {0, 1}, 2, 0.0);
  ASSERT_EQ(model.parameter_count(), 4);
  for (int k = 0; k < 4; ++k) EXPECT_NEAR(model.coefficients(k), g[k], 1e-10);
  EXPECT_THROW(FitLinear(samples, {0, 5}), std::invalid_argument);
  EXPECT_THROW(FitLinear(samples, {0}, 0), std::invalid_argument);
}

TEST(Reservoir, ReadoutOfTheStateAloneIsTheRidgeSolution) {
  const Samples samples = MakeSamples(SomeSequences(3, 300, 5));
  ReservoirConfig config;
  config.hyper.neurons = 40;
  config.ridge_beta = 0.01;
  Eigen::MatrixXd predicted;
  const ReservoirModel model = FitReservoir(samples, config, &predicted);
  ASSERT_EQ(model.parameter_count(), 40);
  // (4.41), dense, from states stepped here.
  const Eigen::MatrixXd w = model.weights.reservoir.Dense();
  Eigen::VectorXd x = Eigen::VectorXd::Zero(40);
  Eigen::MatrixXd left = 0.01 * Eigen::MatrixXd::Identity(40, 40);
  Eigen::VectorXd right = Eigen::VectorXd::Zero(40);
  Eigen::MatrixXd states(40, samples.count());
  const double tau = config.hyper.leak;
  std::size_t next = 0;
  for (int t = 0; t < samples.count(); ++t) {
    if (samples.first[static_cast<std::size_t>(t)] == t) x.setZero();
    const Eigen::VectorXd z =
        w * x + model.weights.input_weight * samples.inputs.col(t) + model.weights.bias;
    x = (1.0 - tau) * x.array() + tau * z.array().tanh();
    states.col(t) = x;
    const bool train = next < samples.train.size() && samples.train[next] == t;
    if (train) ++next;
    if (!train || t - samples.first[static_cast<std::size_t>(t)] < config.washout) continue;
    left += x * x.transpose();
    right += x * samples.targets(0, t);
  }
  const Eigen::VectorXd readout = left.ldlt().solve(right);
  // The equations' condition is about 1e7.
  EXPECT_LT((model.readout.transpose() - readout).cwiseAbs().maxCoeff(), 1e-6);
  EXPECT_LT((predicted - readout.transpose() * states).cwiseAbs().maxCoeff(), 1e-7);
}

TEST(Reservoir, CrossValidationTriesTwentyStrengths) {
  const Samples samples = MakeSamples(SomeSequences(3, 300, 5));
  ReservoirConfig config;
  config.hyper.neurons = 30;
  const ReservoirModel model = FitReservoir(samples, config, nullptr);
  ASSERT_EQ(model.gcv.size(), 20U);
  for (const esn::GcvPoint& point : model.gcv) {
    if (point.beta == model.ridge_beta) continue;
    EXPECT_GE(
        point.score,
        std::min_element(model.gcv.begin(), model.gcv.end(), [](const auto& a, const auto& b) {
          return a.score < b.score;
        })->score);
  }
}

TEST(Reservoir, ChoiceByValidationIsThatOfTryingEveryStrength) {
  const Samples samples = MakeSamples(SomeSequences(3, 300, 5), 0.25, 2);
  ReservoirConfig config;
  config.hyper.neurons = 60;
  config.beta_by_validation = true;
  const ReservoirModel chosen = FitReservoir(samples, config, nullptr);
  double least = std::numeric_limits<double>::infinity();
  double best = 0.0;
  for (const double beta : esn::LogarithmicGrid(config.beta_lower, config.beta_upper, 20)) {
    ReservoirConfig fixed = config;
    fixed.ridge_beta = beta;
    Eigen::MatrixXd predicted;
    (void)FitReservoir(samples, fixed, &predicted);
    const double error = MeanSquare(samples, predicted, samples.validation);
    if (error < least) {
      least = error;
      best = beta;
    }
  }
  EXPECT_EQ(chosen.ridge_beta, best);
  const Samples none = MakeSamples(SomeSequences(3, 300, 5));
  EXPECT_THROW((void)FitReservoir(none, config, nullptr), std::invalid_argument);
}

TEST(Training, EveryNetOfTheTablesLearnsASystemWithMemory) {
  const Samples samples = MakeSamples(SomeSequences(3, 600, 6));
  for (PublishedModel plan : Table62()) {
    plan.training.epochs = 60;
    plan.training.batch = 64;
    plan.training.adam.rate = 0.005;
    const FitResult result = Fit(plan, samples, {0, 1, 2}, 3);
    // The one without memory cannot see the slow part, the published reservoir is slow itself.
    EXPECT_LT(result.test_mse, plan.name == "FFNN"  ? 0.6
                               : plan.name == "ESN" ? 0.2
                                                    : 0.05)
        << plan.name;
    EXPECT_FALSE(result.training.diverged);
  }
}

TEST(Training, TheSameSeedGivesTheSameBits) {
  const Samples samples = MakeSamples(SomeSequences(6, 200, 6));
  for (PublishedModel plan : Table64()) {
    plan.training.epochs = 2;
    const FitResult a = Fit(plan, samples, {0, 1, 2}, 3), b = Fit(plan, samples, {0, 1, 2}, 3);
    EXPECT_EQ((a.predicted - b.predicted).cwiseAbs().maxCoeff(), 0.0) << plan.name;
    if (plan.method == Method::kLinear) continue;
    const FitResult c = Fit(plan, samples, {0, 1, 2}, 4);
    EXPECT_GT((a.predicted - c.predicted).cwiseAbs().maxCoeff(), 0.0) << plan.name;
  }
}

TEST(Training, ValidationStopKeepsTheBestWeights) {
  const Samples samples = MakeSamples(SomeSequences(3, 300, 6), 0.25, 2);
  Net<float> net({.inputs = 3, .hidden = {30, 30}}, 1);
  TrainConfig config;
  config.epochs = 400;
  config.batch = 16;
  config.patience = 10;
  config.adam.rate = 0.01;
  const TrainOutcome outcome = Train(samples, config, &net);
  EXPECT_LT(outcome.epochs, 400);
  EXPECT_EQ(outcome.best_epoch + 10, outcome.epochs);
  EXPECT_DOUBLE_EQ(net.Loss(Data<float>(samples), samples.validation), outcome.validation_mse);
  const Samples none = MakeSamples(SomeSequences(3, 300, 6));
  EXPECT_THROW((void)Train(none, config, &net), std::invalid_argument);
}

TEST(Training, ARateThatDivergesEndsWithFiniteWeights) {
  const Samples samples = MakeSamples(SomeSequences(3, 300, 6));
  Net<float> net({.inputs = 3, .hidden = {10}, .activation = Activation::kRelu}, 1);
  TrainConfig config;
  config.epochs = 50;
  config.adam.rate = 1e18;
  const TrainOutcome outcome = Train(samples, config, &net);
  EXPECT_TRUE(outcome.diverged);
  EXPECT_TRUE(net.parameters().allFinite());
}

// Adam's first step is the rate in every direction, whatever the gradient's size (bias-corrected).
TEST(Adam, FirstStepIsTheRate) {
  Adam<double> adam({.rate = 0.01}, 3);
  Eigen::VectorXd w = Eigen::VectorXd::Zero(3);
  adam.Step(Eigen::Vector3d(1e3, -2.0, 0.5), &w);
  EXPECT_NEAR(w(0), -0.01, 1e-8);
  EXPECT_NEAR(w(1), 0.01, 1e-8);
  EXPECT_NEAR(w(2), -0.01, 1e-8);
  EXPECT_THROW(Adam<double>({.rate = 0.0}, 3), std::invalid_argument);
}

std::vector<Model> TrainedModels(const Samples& samples) {
  std::vector<Model> models;
  std::vector<PublishedModel> plans = Table62();
  for (const PublishedModel& plan : Table64()) {
    if (plan.wiener || plan.method == Method::kLinear) plans.push_back(plan);
  }
  for (PublishedModel plan : plans) {
    plan.training.epochs = 2;
    if (plan.wiener && plan.method == Method::kNet) plan.net.inputs = 4;  // three measured here
    Model model = Fit(plan, samples, {0, 1, 2}, 3).model;
    model.inputs = {"a", "b", "c"};
    model.period_s = 0.0125;
    models.push_back(std::move(model));
  }
  return models;
}

TEST(Stepper, GivesWhatPredictGivesForEveryKind) {
  const std::vector<esn::Sequence> sequences = SomeSequences(3, 200, 8);
  const Samples samples = MakeSamples(sequences);
  for (const Model& model : TrainedModels(samples)) {
    const Eigen::MatrixXd expected = Predict(model, samples);
    Stepper stepper(model);
    double worst = 0.0;
    for (int t = 0; t < 400; ++t) {
      if (t == 200) stepper.Reset();
      const esn::Sequence& q = sequences[t < 200 ? 0 : 1];
      const double y = stepper.Step(q.inputs.row(t % 200).transpose());
      worst = std::max(
          worst, std::abs((y - model.output.offset(0)) / model.output.scale(0) - expected(0, t)));
    }
    // Sums in another order, in float.
    EXPECT_LT(worst, 5e-6) << model.name;
  }
}

TEST(Stepper, TakesNoMemory) {
  const Samples samples = MakeSamples(SomeSequences(3, 200, 8));
  for (const Model& model : TrainedModels(samples)) {
    for (const RecurrentMode mode : {RecurrentMode::kWindow, RecurrentMode::kCarry}) {
      Stepper stepper(model, mode);
      const Eigen::VectorXd u = Eigen::Vector3d(0.1, 0.2, 0.3);
      const long before = test::Allocations();
      double sum = 0.0;
      for (int t = 0; t < 100; ++t) sum += stepper.Step(u);
      EXPECT_EQ(test::Allocations(), before) << model.name;
      EXPECT_TRUE(std::isfinite(sum));
    }
  }
}

TEST(Stepper, BadInputIsNotANumberAndLeavesTheState) {
  const Samples samples = MakeSamples(SomeSequences(3, 200, 8));
  for (const Model& model : TrainedModels(samples)) {
    Stepper a(model), b(model);
    const Eigen::VectorXd u = Eigen::Vector3d(0.1, 0.2, 0.3);
    Eigen::VectorXd bad = u;
    bad(1) = std::numeric_limits<double>::quiet_NaN();
    a.Step(u);
    b.Step(u);
    EXPECT_TRUE(std::isnan(a.Step(bad)));
    EXPECT_TRUE(std::isnan(a.Step(Eigen::VectorXd::Zero(2))));
    EXPECT_EQ(a.Step(u), b.Step(u)) << model.name;
  }
}

TEST(Stepper, StaysBoundedOverALongRun) {
  const Samples samples = MakeSamples(SomeSequences(3, 200, 8));
  for (const Model& model : TrainedModels(samples)) {
    Stepper stepper(model, RecurrentMode::kCarry);
    Eigen::VectorXd u(3);
    double largest = 0.0;
    for (int t = 0; t < 100000; ++t) {
      u << std::sin(0.01 * t), std::cos(0.03 * t), 1.0;
      largest = std::max(largest, std::abs(stepper.Step(u)));
    }
    EXPECT_LT(largest, 1e4) << model.name;
  }
}

TEST(Model, PartsThatDoNotFitAreRefused) {
  const Samples samples = MakeSamples(SomeSequences(3, 200, 8));
  for (Model model : TrainedModels(samples)) {
    EXPECT_NO_THROW(model.Check());
    Model shorter = model;
    shorter.inputs.pop_back();
    EXPECT_THROW(shorter.Check(), std::invalid_argument) << model.name;
    Model timeless = model;
    timeless.period_s = 0.0;
    EXPECT_THROW(timeless.Check(), std::invalid_argument) << model.name;
  }
}

}  // namespace
}  // namespace sinew::networks
