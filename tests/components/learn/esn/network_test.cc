#include "components/learn/esn/network.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <vector>

#include "components/learn/esn/normal.h"
#include "tests/support/allocations.h"

namespace sinew::esn {
namespace {

using simd::Instructions;

std::vector<Instructions> InstructionsHere() {
  std::vector<Instructions> here;
  for (const Instructions set :
       {Instructions::kPortable, Instructions::kAvx2, Instructions::kAvx512}) {
    if (simd::Runs(set)) here.push_back(set);
  }
  return here;
}

Hyperparameters Published(int neurons, int shared_rows = 1) {
  Hyperparameters hyper;
  hyper.neurons = neurons;
  hyper.shared_rows = shared_rows;
  hyper.spectral_radius = 0.95;
  hyper.leak = 0.13;
  hyper.seed = 7;
  return hyper;
}

// Random readout, normalisation that is not trivial.
Weights SomeWeights(int neurons, int inputs, int outputs, int shared_rows = 1) {
  Weights weights = MakeWeights(Published(neurons, shared_rows), inputs, outputs);
  weights.period_s = 1.0 / 240.0;
  NormalGenerator random(99);
  for (Eigen::Index i = 0; i < weights.readout.size(); ++i)
    weights.readout.data()[i] = 0.1 * random.Next();
  for (int m = 0; m < inputs; ++m) {
    weights.input.offset(m) = 0.3 * random.Next();
    weights.input.scale(m) = 0.5 + 0.1 * m;
  }
  return weights;
}

Eigen::VectorXd Excitation(int inputs, int t) {
  Eigen::VectorXd u(inputs);
  for (int m = 0; m < inputs; ++m)
    u(m) = std::sin(0.02 * t * (m + 1)) + 0.2 * std::cos(0.31 * t + m);
  return u;
}

// The equations as they are printed, dense.
class PlainNetwork {
 public:
  explicit PlainNetwork(const Weights& weights)
      : weights_(weights),
        w_(weights.reservoir.Dense()),
        x_(Eigen::VectorXd::Zero(weights.neurons())) {}

  Eigen::VectorXd Step(const Eigen::VectorXd& u) {
    const double limit = weights_.hyper.input_limit;
    const Eigen::VectorXd n = (u - weights_.input.offset)
                                  .cwiseQuotient(weights_.input.scale)
                                  .cwiseMax(-limit)
                                  .cwiseMin(limit);
    const Eigen::VectorXd z = w_ * x_ + weights_.input_weight * n + weights_.bias;
    const double tau = weights_.hyper.leak;
    x_ = (1.0 - tau) * x_ + tau * z.unaryExpr([](double v) { return std::tanh(v); });
    Eigen::VectorXd features(1 + n.size() + x_.size());
    features << 1.0, n, x_;
    return weights_.readout * features;
  }

 private:
  const Weights& weights_;
  Eigen::MatrixXd w_;
  Eigen::VectorXd x_;
};

// Rounding of sums of some hundred terms of order 1; the reservoir of rho < 1 does not amplify it.
constexpr double kRounding = 1e-12;

TEST(Network, StepEqualsTheDenseEquations) {
  for (const auto& [neurons, inputs, outputs, shared_rows] : {std::tuple{1, 1, 1, 1},
                                                              {16, 3, 1, 1},
                                                              {78, 6, 2, 1},
                                                              {470, 3, 1, 1},
                                                              {3, 1, 1, 4},
                                                              {16, 3, 1, 4},
                                                              {78, 6, 2, 4},
                                                              {470, 3, 1, 4}}) {
    const Weights weights = SomeWeights(neurons, inputs, outputs, shared_rows);
    Network network(weights);
    PlainNetwork plain(weights);
    for (int t = 0; t < 500; ++t) {
      const Eigen::VectorXd u = Excitation(inputs, t);
      const Eigen::VectorXd expected = plain.Step(u);
      ASSERT_EQ(network.Step(u), StepStatus::kOk);
      ASSERT_LT((network.prediction() - expected).cwiseAbs().maxCoeff(), kRounding)
          << neurons << " neurons, " << shared_rows << " shared rows, at " << t;
    }
  }
}

TEST(Network, EveryInstructionSetGivesTheSameBits) {
  for (const int shared_rows : {1, 4}) {
    const Weights weights = SomeWeights(77, 5, 3, shared_rows);
    for (const Instructions set : InstructionsHere()) {
      Network reference(weights, Instructions::kPortable);
      Network network(weights, set);
      for (int t = 0; t < 2000; ++t) {
        const Eigen::VectorXd u = Excitation(5, t);
        ASSERT_EQ(network.Step(u), reference.Step(u));
        ASSERT_EQ(network.features(), reference.features())
            << simd::Name(set) << ", " << shared_rows << " shared rows, at " << t;
      }
    }
  }
}

// One entry of the last row is zero. In the second network it has another column, so that the rows
// do not share their columns any more and the other loop is taken, which adds the same numbers.
TEST(Network, SharedColumnsGiveTheBitsOfColumnsOfTheirOwn) {
  for (const Instructions set : InstructionsHere()) {
    Weights weights = SomeWeights(80, 3, 1, 4);
    weights.reservoir.value.back() = 0.0;
    Weights other = weights;
    int& column = other.reservoir.column.back();
    column = column == 79 ? 78 : 79;
    if (*(&column - 1) >= column) {
      GTEST_FAIL() << "column " << column << " is taken: take another seed";
    }
    Network shared(weights, set);
    Network own(other, set);
    for (int t = 0; t < 500; ++t) {
      ASSERT_EQ(shared.Step(Excitation(3, t)), StepStatus::kOk);
      ASSERT_EQ(own.Step(Excitation(3, t)), StepStatus::kOk);
      ASSERT_EQ(shared.features(), own.features()) << simd::Name(set) << " at " << t;
      ASSERT_EQ(shared.prediction(), own.prediction()) << simd::Name(set) << " at " << t;
    }
  }
}

TEST(Network, ForgetsItsInitialStateWhenTheSpectralRadiusIsBelowOne) {
  const Weights weights = SomeWeights(100, 3, 1);
  Network a(weights);
  Network b(weights);
  b.SetState(Eigen::VectorXd::LinSpaced(100, -1.0, 1.0));
  const double start = (a.state() - b.state()).norm();
  for (int t = 0; t < 3000; ++t) {
    ASSERT_EQ(a.Step(Excitation(3, t)), StepStatus::kOk);
    ASSERT_EQ(b.Step(Excitation(3, t)), StepStatus::kOk);
  }
  EXPECT_GT(start, 1.0);
  EXPECT_LT((a.state() - b.state()).norm(), 1e-12 * start);
}

TEST(Network, SettlingGoesWhereAConstantInputEndsFromAnyState) {
  const Weights weights = SomeWeights(100, 3, 1);
  Network settled(weights);
  ASSERT_EQ(settled.Settle(Excitation(3, 7)), StepStatus::kOk);
  const Eigen::VectorXd before = settled.state();
  const Eigen::VectorXd prediction = settled.prediction();
  ASSERT_EQ(settled.Step(Excitation(3, 7)), StepStatus::kOk);
  EXPECT_LT((settled.state() - before).lpNorm<Eigen::Infinity>(), kSettled);
  EXPECT_LT((settled.prediction() - prediction).norm(), 1e-6 * (1.0 + prediction.norm()));
  Network stepped(weights);
  stepped.SetState(Eigen::VectorXd::LinSpaced(100, -1.0, 1.0));
  for (int t = 0; t < 3000; ++t) ASSERT_EQ(stepped.Step(Excitation(3, 7)), StepStatus::kOk);
  EXPECT_LT((stepped.state() - before).lpNorm<Eigen::Infinity>(), 1e-6);
  EXPECT_EQ(settled.Settle(Eigen::VectorXd::Zero(2)), StepStatus::kBadInput);
}

TEST(Network, StateStaysWithinOneForAnyInput) {
  Hyperparameters hyper = Published(60);
  hyper.spectral_radius = 1.5;
  Weights weights = MakeWeights(hyper, 2, 1);
  weights.period_s = 0.01;
  Network network(weights);
  NormalGenerator random(3);
  for (int t = 0; t < 100000; ++t) {
    const Eigen::VectorXd u = Eigen::Vector2d(1e6 * random.Next(), random.Next());
    ASSERT_EQ(network.Step(u), StepStatus::kOk);
    ASSERT_LE(network.state().cwiseAbs().maxCoeff(), 1.0);
  }
}

TEST(Network, ZeroInputAndZeroBiasStayAtZero) {
  Weights weights = MakeWeights(Published(20), 1, 1);
  weights.period_s = 0.01;
  weights.bias.setZero();
  Network network(weights);
  ASSERT_EQ(network.Step(Eigen::VectorXd::Zero(1)), StepStatus::kOk);
  EXPECT_EQ(network.state(), Eigen::VectorXd::Zero(20));
  EXPECT_EQ(network.prediction()(0), 0.0);
}

TEST(Network, AnInputThatIsNotFiniteChangesNothingAndPredictsZero) {
  const Weights weights = SomeWeights(30, 2, 1);
  Network network(weights);
  Network untouched(weights);
  for (int t = 0; t < 50; ++t) {
    ASSERT_EQ(network.Step(Excitation(2, t)), StepStatus::kOk);
    ASSERT_EQ(untouched.Step(Excitation(2, t)), StepStatus::kOk);
    for (const double bad :
         {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
      EXPECT_EQ(network.Step(Eigen::Vector2d(0.0, bad)), StepStatus::kBadInput);
      EXPECT_EQ(network.prediction()(0), 0.0);
    }
    ASSERT_EQ(network.state(), untouched.state());
  }
  EXPECT_EQ(network.Step(Eigen::VectorXd::Zero(3)), StepStatus::kBadInput);
}

TEST(Network, RefusesAReadoutThatDoesNotFitOrIsNotFinite) {
  const Weights weights = SomeWeights(30, 2, 1);
  Network network(weights);
  EXPECT_FALSE(network.SetReadout(Eigen::MatrixXd::Zero(1, 5)));
  Eigen::MatrixXd bad = weights.readout;
  bad(0, 3) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(network.SetReadout(bad));
  EXPECT_EQ(network.readout(), weights.readout);
  const Eigen::MatrixXd good = 2.0 * weights.readout;
  EXPECT_TRUE(network.SetReadout(good));
  EXPECT_EQ(network.readout(), good);
}

TEST(Network, StepAndSetReadoutTakeNoMemory) {
  const Weights weights = SomeWeights(470, 3, 2);
  Network network(weights);
  const Eigen::VectorXd u = Excitation(3, 1);
  const Eigen::MatrixXd readout = 0.5 * weights.readout;
  bool good = true;
  const long before = test::Allocations();
  for (int t = 0; t < 100; ++t) {
    good = good && network.Step(u) == StepStatus::kOk && network.SetReadout(readout);
  }
  const long taken = test::Allocations() - before;
  EXPECT_EQ(taken, 0);
  EXPECT_TRUE(good);
}

TEST(Network, TheSameSeedGivesTheSameNetworkAndAnotherSeedAnother) {
  const Weights a = MakeWeights(Published(50), 3, 1);
  const Weights b = MakeWeights(Published(50), 3, 1);
  EXPECT_EQ(a.reservoir.value, b.reservoir.value);
  EXPECT_EQ(a.reservoir.column, b.reservoir.column);
  EXPECT_EQ(a.input_weight, b.input_weight);
  EXPECT_EQ(a.bias, b.bias);
  Hyperparameters other = Published(50);
  other.seed = 8;
  EXPECT_NE(MakeWeights(other, 3, 1).reservoir.value, a.reservoir.value);
  // W is drawn first: it does not depend on the number of inputs.
  EXPECT_EQ(MakeWeights(Published(50), 5, 1).reservoir.value, a.reservoir.value);
}

TEST(Weights, SpectralRadiusIsWhatDenseEigenvaluesSay) {
  for (const double rho : {0.5, 0.95, 1.25}) {
    Hyperparameters hyper = Published(120);
    hyper.spectral_radius = rho;
    const Weights weights = MakeWeights(hyper, 2, 1);
    const Eigen::VectorXcd eigenvalues = weights.reservoir.Dense().eigenvalues();
    EXPECT_NEAR(eigenvalues.cwiseAbs().maxCoeff(), rho, 1e-10);
    // As a second opinion, the growth of powers: |W^n|^(1/n) tends to rho from above.
    Eigen::MatrixXd power = weights.reservoir.Dense() / rho;
    for (int i = 0; i < 10; ++i) power *= power;  // W^1024
    EXPECT_NEAR(std::pow(power.norm(), 1.0 / 1024.0), 1.0, 0.01);
  }
}

TEST(Weights, GroupsOfFourRowsShareTheirColumnsAndNotTheirValues) {
  const Weights weights = MakeWeights(Published(470, 4), 3, 1);
  const EllMatrix& w = weights.reservoir;
  EXPECT_EQ(w.entries, 47);
  EXPECT_NEAR(SpectralRadius(w), 0.95, 1e-10);
  const auto columns = [&w](int row) {
    return std::vector<int>(w.column.begin() + row * w.entries,
                            w.column.begin() + (row + 1) * w.entries);
  };
  int equal_groups = 0;
  for (int row = 0; row < 470; ++row) {
    EXPECT_EQ(columns(row), columns(row / 4 * 4)) << row;
    if (row % 4 == 0 && row > 0 && columns(row) == columns(row - 4)) ++equal_groups;
    if (row == 0) continue;
    const auto first = static_cast<std::size_t>(row * w.entries);
    EXPECT_NE(w.value[first], w.value[first - static_cast<std::size_t>(w.entries)]) << row;
  }
  EXPECT_EQ(equal_groups, 0);
}

TEST(Weights, EveryRowHasTheSameNumberOfEntriesAndTheNumbersAreNormal) {
  Hyperparameters hyper = Published(470);
  hyper.input_variance = 0.1;
  const Weights weights = MakeWeights(hyper, 3, 1);
  EXPECT_EQ(weights.reservoir.entries, 47);
  const Eigen::MatrixXd dense = weights.reservoir.Dense();
  for (int row = 0; row < 470; ++row) EXPECT_EQ((dense.row(row).array() != 0.0).count(), 47);
  // Four standard errors of mean and variance of the draws.
  const auto expect_moments = [](const Eigen::VectorXd& v, double variance) {
    const double n = static_cast<double>(v.size());
    EXPECT_NEAR(v.mean(), 0.0, 4.0 * std::sqrt(variance / n));
    EXPECT_NEAR((v.array() - v.mean()).square().mean(), variance,
                4.0 * variance * std::sqrt(2.0 / n));
  };
  expect_moments(weights.bias, 1.0);
  expect_moments(weights.input_weight.reshaped(), 0.1);
  // Before scaling the entries had variance 1: density * N * variance = rho_raw^2 (circular law),
  // within 15 %.
  const Eigen::Map<const Eigen::VectorXd> values(
      weights.reservoir.value.data(), static_cast<Eigen::Index>(weights.reservoir.value.size()));
  EXPECT_NEAR(std::sqrt(47.0 * values.squaredNorm() / static_cast<double>(values.size())), 0.95,
              0.15 * 0.95);
}

TEST(Weights, ImpossibleHyperparametersAreNamed) {
  const auto message = [](auto change) {
    Hyperparameters hyper = Published(10);
    change(hyper);
    try {
      MakeWeights(hyper, 1, 1);
    } catch (const std::invalid_argument& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_THAT(message([](Hyperparameters& h) { h.neurons = 0; }),
              testing::StartsWith("neurons: 0"));
  EXPECT_THAT(message([](Hyperparameters& h) { h.leak = 1.5; }), testing::StartsWith("leak: 1.5"));
  EXPECT_THAT(message([](Hyperparameters& h) { h.density = 0.0; }),
              testing::StartsWith("density: 0"));
  EXPECT_THAT(message([](Hyperparameters& h) { h.shared_rows = 2; }),
              testing::StartsWith("shared_rows: 2"));
  EXPECT_THAT(message([](Hyperparameters& h) { h.spectral_radius = std::nan(""); }),
              testing::StartsWith("spectral_radius: "));
  EXPECT_THAT(message([](Hyperparameters& h) { h.input_variance = -1.0; }),
              testing::StartsWith("input_variance: -1"));
  EXPECT_THAT(message([](Hyperparameters& h) { h.input_limit = 0.0; }),
              testing::StartsWith("input_limit: 0"));
}

TEST(Weights, ShapesThatDoNotFitAreRefused) {
  const Weights good = SomeWeights(10, 2, 1);
  EXPECT_NO_THROW(Network{good});
  const auto refuse = [&](auto change) {
    Weights bad = good;
    change(bad);
    EXPECT_THROW(Network{bad}, std::invalid_argument);
  };
  refuse([](Weights& w) { w.bias.conservativeResize(9); });
  refuse([](Weights& w) { w.readout.conservativeResize(1, 12); });
  refuse([](Weights& w) { w.reservoir.column[0] = 10; });
  refuse([](Weights& w) { w.reservoir.column[0] = -1; });
  refuse([](Weights& w) { w.reservoir.value.pop_back(); });
  refuse([](Weights& w) { w.reservoir.value[3] = std::nan(""); });
  refuse([](Weights& w) { w.input.scale(0) = 0.0; });
  refuse([](Weights& w) { w.period_s = 0.0; });
}

TEST(Tanh, IsWithinThreeUnitsInTheLastPlaceOfTheLibrary) {
  // Dense near 0, where a naive formula cancels, and over the whole range to saturation.
  std::vector<double> points = {0.0,  -0.0, 1e-300, -1e-18, 1e-9,  19.0,
                                19.1, 20.0, 25.0,   1e6,    -1e300};
  for (int i = -200000; i <= 200000; ++i) points.push_back(i * 1.1e-4);
  for (double x = 1e-12; x < 1.0; x *= 1.0007) points.push_back(x);
  const Eigen::Map<const Eigen::VectorXd> x(points.data(),
                                            static_cast<Eigen::Index>(points.size()));
  for (const Instructions set : InstructionsHere()) {
    Eigen::VectorXd y = x;
    Tanh(y, set);
    double worst = 0.0;
    for (Eigen::Index i = 0; i < x.size(); ++i) {
      const double expected = std::tanh(x(i));
      const double ulp = std::nextafter(std::abs(expected), 2.0) - std::abs(expected);
      worst = std::max(worst, std::abs(y(i) - expected) / ulp);
      ASSERT_LE(std::abs(y(i)), 1.0) << x(i);
      ASSERT_EQ(std::signbit(y(i)), std::signbit(x(i))) << x(i);
    }
    EXPECT_LE(worst, 3.0) << simd::Name(set);
    RecordProperty(simd::Name(set), std::to_string(worst));
  }
}

TEST(Tanh, HandlesWhatIsNotFinite) {
  for (const Instructions set : InstructionsHere()) {
    Eigen::VectorXd y(4);
    y << std::nan(""), std::numeric_limits<double>::infinity(),
        -std::numeric_limits<double>::infinity(), 0.5;
    Tanh(y, set);
    EXPECT_TRUE(std::isnan(y(0)));
    EXPECT_EQ(y(1), 1.0);
    EXPECT_EQ(y(2), -1.0);
    EXPECT_NEAR(y(3), std::tanh(0.5), 1e-15);
  }
}

}  // namespace
}  // namespace sinew::esn
