#include "reproduction/networks/net.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>
#include <vector>

#include "components/learn/esn/normal.h"
#include "reproduction/networks/dispatch.h"
#include "reproduction/networks/kernel.h"

namespace sinew::networks {
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

Samples RandomSamples(int inputs, int outputs, int count, std::uint64_t seed) {
  esn::NormalGenerator random(seed);
  Samples samples;
  samples.inputs.resize(inputs, count);
  samples.targets.resize(outputs, count);
  for (int t = 0; t < count; ++t) {
    for (int m = 0; m < inputs; ++m) samples.inputs(m, t) = random.Next();
    for (int o = 0; o < outputs; ++o) samples.targets(o, t) = random.Next();
    samples.first.push_back(t < count / 2 ? 0 : count / 2);
    samples.train.push_back(t);
  }
  return samples;
}

struct Case {
  const char* name;
  Architecture architecture;
};

std::vector<Case> Cases() {
  return {
      {"ffnn tanh", {.inputs = 3, .hidden = {20, 20, 4}}},
      {"ffnn relu", {.inputs = 7, .hidden = {6, 4}, .activation = Activation::kRelu}},
      {"ffnn relu dropout",
       {.inputs = 7, .hidden = {8, 6}, .activation = Activation::kRelu, .dropout = 0.2}},
      {"ffnn tanh dropout", {.inputs = 4, .hidden = {9}, .dropout = 0.5}},
      {"ffnn without hidden layer", {.inputs = 5, .outputs = 3}},
      {"nnx", {.inputs = 3, .memory = 10, .hidden = {10, 10, 10}}},
      {"ffnn many outputs", {.inputs = 36, .outputs = 12, .hidden = {14, 11, 9}}},
      {"lstm", {.kind = Kind::kLstm, .inputs = 3, .memory = 12, .hidden = {10}}},
      {"lstm memory 1", {.kind = Kind::kLstm, .inputs = 6, .memory = 1, .hidden = {2}}},
      {"lstm outputs",
       {.kind = Kind::kLstm, .inputs = 2, .outputs = 3, .memory = 4, .hidden = {5}}},
      {"gru", {.kind = Kind::kGru, .inputs = 3, .memory = 10, .hidden = {11}}},
      {"gru outputs", {.kind = Kind::kGru, .inputs = 2, .outputs = 2, .memory = 3, .hidden = {1}}},
  };
}

// Central differences of step h leave an error of order h^2 and rounding / h: 1e-5 in double gives
// about 1e-9 of an error of about 1.
constexpr double kStep = 1e-5;
constexpr double kGradientTolerance = 2e-8;

TEST(Net, GradientIsThatOfFiniteDifferencesForEveryKind) {
  for (const Case& c : Cases()) {
    const Samples samples = RandomSamples(c.architecture.inputs, c.architecture.outputs, 45, 11);
    const Data<double> data(samples);
    Net<double> net(c.architecture, 5);
    // Biases too must not be at a special value.
    esn::NormalGenerator random(3);
    for (double& w : net.parameters()) w += 0.1 * random.Next();
    net.SeedDropout(9);
    net.LossAndGradient(data, samples.train);
    const Eigen::VectorXd gradient = net.gradient();
    double worst = 0.0;
    for (Eigen::Index p = 0; p < gradient.size(); ++p) {
      const double before = net.parameters()(p);
      net.parameters()(p) = before + kStep;
      net.SeedDropout(9);
      const double up = net.LossAndGradient(data, samples.train);
      net.parameters()(p) = before - kStep;
      net.SeedDropout(9);
      const double down = net.LossAndGradient(data, samples.train);
      net.parameters()(p) = before;
      worst = std::max(worst, std::abs(gradient(p) - (up - down) / (2.0 * kStep)));
    }
    EXPECT_LT(worst, kGradientTolerance) << c.name;
    EXPECT_GT(gradient.norm(), 1e-3) << c.name;
  }
}

TEST(Net, EveryInstructionSetGivesTheSameBits) {
  for (const Case& c : Cases()) {
    const Samples samples = RandomSamples(c.architecture.inputs, c.architecture.outputs, 77, 12);
    const Data<float> data(samples);
    Net<float> reference(c.architecture, 5, Instructions::kPortable);
    const double loss = reference.LossAndGradient(data, samples.train);
    for (const Instructions set : InstructionsHere()) {
      Net<float> net(c.architecture, 5, set);
      EXPECT_EQ(net.LossAndGradient(data, samples.train), loss) << c.name << simd::Name(set);
      EXPECT_EQ((net.gradient() - reference.gradient()).cwiseAbs().maxCoeff(), 0.0F)
          << c.name << simd::Name(set);
    }
  }
}

TEST(Net, FloatAgreesWithDouble) {
  // About a hundred sums of rounding 6e-8.
  constexpr double kFloatTolerance = 1e-5;
  for (const Case& c : Cases()) {
    // Their tiles differ in width, so that what dropout leaves out does too.
    if (c.architecture.dropout > 0.0) continue;
    const Samples samples = RandomSamples(c.architecture.inputs, c.architecture.outputs, 40, 13);
    Net<float> single(c.architecture, 5);
    Net<double> precise(c.architecture, 5);
    precise.parameters() = single.parameters().cast<double>();
    single.SeedDropout(4);
    precise.SeedDropout(4);
    EXPECT_NEAR(single.LossAndGradient(Data<float>(samples), samples.train),
                precise.LossAndGradient(Data<double>(samples), samples.train), kFloatTolerance)
        << c.name;
    EXPECT_LT((single.gradient().cast<double>() - precise.gradient()).cwiseAbs().maxCoeff(),
              kFloatTolerance)
        << c.name;
  }
}

// (4.28)-(4.32) as they are printed, one sample.
double PlainLstm(const Net<double>& net, const Samples& samples, int sample) {
  const Architecture& a = net.architecture();
  const int units = a.hidden[0];
  const std::vector<Block> blocks = Blocks(a);
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const Eigen::Map<const Rows> w(net.parameters().data(), blocks[0].out, blocks[0].in);
  const Eigen::Map<const Rows> v(net.parameters().data() + blocks[1].offset, blocks[1].out,
                                 blocks[1].in);
  const auto sigmoid = [](const Eigen::ArrayXd& x) -> Eigen::ArrayXd {
    return 1.0 / (1.0 + (-x).exp());
  };
  Eigen::ArrayXd h = Eigen::ArrayXd::Zero(units), c = Eigen::ArrayXd::Zero(units);
  for (int s = 0; s < a.memory; ++s) {
    const int t =
        std::max(sample - a.memory + 1 + s, samples.first[static_cast<std::size_t>(sample)]);
    Eigen::VectorXd x(a.inputs + units + 1);
    x << samples.inputs.col(t), h.matrix(), 1.0;
    const Eigen::ArrayXd z = (w * x).array();
    const Eigen::ArrayXd i = sigmoid(z.segment(0, units));
    const Eigen::ArrayXd f = sigmoid(z.segment(units, units));
    const Eigen::ArrayXd g = z.segment(2 * units, units).tanh();
    const Eigen::ArrayXd o = sigmoid(z.segment(3 * units, units));
    c = f * c + i * g;
    h = o * c.tanh();
  }
  Eigen::VectorXd last(units + 1);
  last << h.matrix(), 1.0;
  return (v * last)(0);
}

TEST(Net, LstmIsThePrintedOne) {
  const Architecture a{.kind = Kind::kLstm, .inputs = 3, .memory = 12, .hidden = {10}};
  const Samples samples = RandomSamples(3, 1, 30, 21);
  Net<double> net(a, 8);
  Eigen::MatrixXd y = Eigen::MatrixXd::Zero(1, 30);
  net.Predict(Data<double>(samples), samples.train, &y);
  for (int t = 0; t < 30; ++t) EXPECT_NEAR(y(0, t), PlainLstm(net, samples, t), 1e-13) << t;
}

// (4.33)-(4.36), the reset gate behind the product.
TEST(Net, GruIsThePrintedOneWithTheResetGateBehindTheProduct) {
  const Architecture a{.kind = Kind::kGru, .inputs = 2, .memory = 5, .hidden = {4}};
  const Samples samples = RandomSamples(2, 1, 20, 22);
  Net<double> net(a, 8);
  esn::NormalGenerator random(3);
  for (double& w : net.parameters()) w += 0.2 * random.Next();
  Eigen::MatrixXd y = Eigen::MatrixXd::Zero(1, 20);
  net.Predict(Data<double>(samples), samples.train, &y);
  const std::vector<Block> blocks = Blocks(a);
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const auto matrix = [&](int b) {
    const Block& block = blocks[static_cast<std::size_t>(b)];
    return Eigen::Map<const Rows>(net.parameters().data() + block.offset, block.out, block.in);
  };
  const auto sigmoid = [](const Eigen::ArrayXd& x) -> Eigen::ArrayXd {
    return 1.0 / (1.0 + (-x).exp());
  };
  for (int sample = 0; sample < 20; ++sample) {
    Eigen::ArrayXd h = Eigen::ArrayXd::Zero(4);
    for (int s = 0; s < 5; ++s) {
      const int t = std::max(sample - 4 + s, samples.first[static_cast<std::size_t>(sample)]);
      Eigen::VectorXd x(3), hb(5);
      x << samples.inputs.col(t), 1.0;
      hb << h.matrix(), 1.0;
      const Eigen::ArrayXd p = (matrix(0) * x).array(), q = (matrix(1) * hb).array();
      const Eigen::ArrayXd r = sigmoid(p.segment(0, 4) + q.segment(0, 4));
      const Eigen::ArrayXd z = sigmoid(p.segment(4, 4) + q.segment(4, 4));
      const Eigen::ArrayXd m = (p.segment(8, 4) + r * q.segment(8, 4)).tanh();
      h = (1.0 - z) * h + z * m;
    }
    Eigen::VectorXd last(5);
    last << h.matrix(), 1.0;
    EXPECT_NEAR(y(0, sample), (matrix(2) * last)(0), 1e-13) << sample;
  }
}

TEST(Net, TanhIsWithinAFewUnitsInTheLastPlace) {
  for (const Instructions set : InstructionsHere()) {
    std::vector<float> x;
    for (double v = -12.0; v <= 12.0; v += 0.00075) x.push_back(static_cast<float>(v));
    x.resize(x.size() / 16 * 16);
    std::vector<float> y = x;
    internal::KernelFor<float>(set).tanh(y.data(), static_cast<int>(y.size()));
    for (std::size_t k = 0; k < x.size(); ++k) {
      const double exact = std::tanh(static_cast<double>(x[k]));
      // A unit in the last place of a float is 1.2e-7 relative.
      ASSERT_NEAR(y[k], exact, 6e-7 * std::abs(exact)) << x[k] << " " << simd::Name(set);
    }
  }
}

TEST(Net, NotANumberStaysNotANumber) {
  const Architecture a{.inputs = 3, .hidden = {4}};
  Samples samples = RandomSamples(3, 1, 20, 1);
  samples.inputs(0, 3) = std::numeric_limits<double>::quiet_NaN();
  Net<float> net(a, 1);
  EXPECT_TRUE(std::isnan(net.LossAndGradient(Data<float>(samples), samples.train)));
}

TEST(Net, WindowsDoNotReachIntoTheSequenceBefore) {
  const Architecture a{.inputs = 1, .memory = 5, .hidden = {3}};
  Samples samples = RandomSamples(1, 1, 40, 2);
  Net<float> net(a, 1);
  Eigen::MatrixXd before = Eigen::MatrixXd::Zero(1, 40), after = before;
  net.Predict(Data<float>(samples), samples.train, &before);
  samples.inputs.leftCols(20).setConstant(100.0);
  net.Predict(Data<float>(samples), samples.train, &after);
  EXPECT_EQ((before - after).rightCols(20).cwiseAbs().maxCoeff(), 0.0);
}

TEST(Net, ImpossibleShapesAreRefusedWithTheirValue) {
  const auto message = [](const Architecture& a) -> std::string {
    try {
      Net<float> net(a, 1);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "";
  };
  using testing::HasSubstr;
  EXPECT_THAT(message({.inputs = 0}), HasSubstr("inputs: 0"));
  EXPECT_THAT(message({.memory = 0}), HasSubstr("memory: 0"));
  EXPECT_THAT(message({.hidden = {3, -1}}), HasSubstr("hidden: -1"));
  EXPECT_THAT(message({.kind = Kind::kLstm, .hidden = {3, 3}}), HasSubstr("hidden: 2 layers"));
  EXPECT_THAT(message({.hidden = {3}, .dropout = 1.0}), HasSubstr("dropout"));
  EXPECT_THAT(message({.kind = Kind::kGru, .hidden = {3}, .dropout = 0.2}), HasSubstr("dropout"));
}

}  // namespace
}  // namespace sinew::networks
