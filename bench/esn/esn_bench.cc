// Speed of the echo state network: a step beside the same step with a dense matrix, and ridge
// regression.
//   cmake --preset release -DSINEW_BUILD_BENCH=ON && cmake --build build/release --target esn_bench
//   build/release/bin/esn_bench
// Goals on one core of a 3.5 GHz server processor: step of 470 neurons 6.5 us, ridge of 8000
// samples 0.1 s.
#include <benchmark/benchmark.h>

#include <cmath>

#include "components/esn/network.h"
#include "components/esn/ridge.h"
#include "components/esn/training.h"

namespace sinew::esn {
namespace {

Weights SomeWeights(int neurons, int inputs, int outputs) {
  Hyperparameters hyper;
  hyper.neurons = neurons;
  hyper.spectral_radius = 0.95;
  hyper.leak = 0.13;
  Weights weights = MakeWeights(hyper, inputs, outputs);
  weights.period_s = 1.0 / 240.0;
  weights.readout.setConstant(0.01);
  return weights;
}

Eigen::MatrixXd SomeInputs(int inputs, int count) {
  Eigen::MatrixXd u(inputs, count);
  for (int t = 0; t < count; ++t) {
    for (int m = 0; m < inputs; ++m) u(m, t) = std::sin(0.01 * t * (m + 1));
  }
  return u;
}

// Arguments: neurons, inputs, outputs, instruction set.
void Step(benchmark::State& state) {
  const int inputs = static_cast<int>(state.range(1));
  const auto instructions = static_cast<simd::Instructions>(state.range(3));
  if (!simd::Runs(instructions)) {
    state.SkipWithError("instruction set not available here");
    return;
  }
  Network network(
      SomeWeights(static_cast<int>(state.range(0)), inputs, static_cast<int>(state.range(2))),
      instructions);
  const Eigen::MatrixXd u = SomeInputs(inputs, 1024);
  Eigen::Index t = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(network.Step(u.col(t++ & 1023)));
  }
  state.SetLabel(simd::Name(instructions));
}
void StepArguments(benchmark::internal::Benchmark* b) {
  for (const int set : {0, 1, 2}) {
    b->Args({470, 3, 1, set})->Args({78, 6, 1, set})->Args({76, 36, 12, set});
  }
}
BENCHMARK(Step)->Apply(StepArguments)->Unit(benchmark::kMicrosecond);

void DenseStep(benchmark::State& state) {
  const int inputs = static_cast<int>(state.range(1));
  const Weights weights =
      SomeWeights(static_cast<int>(state.range(0)), inputs, static_cast<int>(state.range(2)));
  const Eigen::MatrixXd w = weights.reservoir.Dense();
  const Eigen::MatrixXd u = SomeInputs(inputs, 1024);
  const int n = weights.neurons();
  Eigen::VectorXd features = Eigen::VectorXd::Zero(weights.feature_count());
  Eigen::VectorXd z(n);
  Eigen::VectorXd y(weights.output_count());
  Eigen::Index t = 0;
  const double leak = weights.hyper.leak;
  for (auto _ : state) {
    auto x = features.tail(n);
    z.noalias() = w * x;
    z.noalias() += weights.input_weight * u.col(t++ & 1023);
    z += weights.bias;
    x = (1.0 - leak) * x.array() + leak * z.array().tanh();
    y.noalias() = weights.readout * features;
    benchmark::DoNotOptimize(y.data());
  }
}
BENCHMARK(DenseStep)
    ->Args({470, 3, 1})
    ->Args({78, 6, 1})
    ->Args({76, 36, 12})
    ->Unit(benchmark::kMicrosecond);

// Argument: neurons. Normal equations of 8000 samples and their solution; the states are there
// already.
void Ridge(benchmark::State& state) {
  const int n = static_cast<int>(state.range(0));
  Network network(SomeWeights(n, 3, 1));
  const Eigen::MatrixXd u = SomeInputs(3, 8000);
  Eigen::MatrixXd features(network.feature_count(), 8000);
  for (Eigen::Index t = 0; t < 8000; ++t) {
    if (network.Step(u.col(t)) == StepStatus::kOk) features.col(t) = network.features();
  }
  const Eigen::VectorXd target = Eigen::VectorXd::Constant(1, 0.3);
  for (auto _ : state) {
    NormalEquations equations(network.feature_count(), 1);
    for (Eigen::Index t = 0; t < 8000; ++t) {
      if (!equations.Add(features.col(t), target)) state.SkipWithError("not finite");
    }
    benchmark::DoNotOptimize(SolveRidge(equations, 0.01));
  }
}
BENCHMARK(Ridge)->Arg(470)->Arg(78)->Unit(benchmark::kMillisecond);

// Argument: neurons. 20 values of beta.
void Gcv(benchmark::State& state) {
  const int n = static_cast<int>(state.range(0));
  Network network(SomeWeights(n, 3, 1));
  const Eigen::MatrixXd u = SomeInputs(3, 8000);
  NormalEquations equations(network.feature_count(), 1);
  const Eigen::VectorXd target = Eigen::VectorXd::Constant(1, 0.3);
  for (Eigen::Index t = 0; t < 8000; ++t) {
    if (network.Step(u.col(t)) == StepStatus::kOk && !equations.Add(network.features(), target))
      return;
  }
  for (auto _ : state) {
    benchmark::DoNotOptimize(GeneralisedCrossValidation(equations, LogarithmicGrid(1e-6, 1e4, 20)));
  }
}
BENCHMARK(Gcv)->Arg(470)->Arg(78)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace sinew::esn

BENCHMARK_MAIN();
