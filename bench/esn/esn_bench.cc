// Speed of the echo state network: a step beside the same step with a dense matrix, and ridge
// regression.
//   cmake --preset release -DSINEW_BUILD_BENCH=ON && cmake --build build/release --target esn_bench
//   build/release/bin/esn_bench
// Goals on one core of a 3.5 GHz server processor: step of 470 neurons 6.5 us and at most 0.15 of
// the dense step, the default within 1.1 of the fastest instruction set (Ratio); ridge of 8000
// samples 0.1 s.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <type_traits>
#include <vector>

#include "components/learn/esn/network.h"
#include "components/learn/esn/ridge.h"
#include "components/learn/esn/training.h"

namespace sinew::esn {
namespace {

Weights SomeWeights(int neurons, int inputs, int outputs,
                    int shared_rows = Hyperparameters{}.shared_rows) {
  Hyperparameters hyper;
  hyper.shared_rows = shared_rows;
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

// Arguments: neurons, inputs, outputs, instruction set, rows that share their columns.
void Step(benchmark::State& state) {
  const int inputs = static_cast<int>(state.range(1));
  const auto instructions = static_cast<simd::Instructions>(state.range(3));
  if (!simd::Runs(instructions)) {
    state.SkipWithError("instruction set not available here");
    return;
  }
  Network network(SomeWeights(static_cast<int>(state.range(0)), inputs,
                              static_cast<int>(state.range(2)), static_cast<int>(state.range(4))),
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
    for (const int shared : {1, 4}) {
      b->Args({470, 3, 1, set, shared})->Args({78, 6, 1, set, shared});
      b->Args({76, 36, 12, set, shared});
    }
  }
}
BENCHMARK(Step)->Apply(StepArguments)->Unit(benchmark::kMicrosecond);

// The step with a dense matrix, by Eigen.
class DenseNetwork {
 public:
  explicit DenseNetwork(const Weights& weights)
      : weights_(weights),
        w_(weights.reservoir.Dense()),
        features_(Eigen::VectorXd::Zero(weights.feature_count())),
        z_(weights.neurons()),
        y_(weights.output_count()) {}

  void Step(const Eigen::Ref<const Eigen::VectorXd>& u) {
    auto x = features_.tail(w_.rows());
    z_.noalias() = w_ * x;
    z_.noalias() += weights_.input_weight * u;
    z_ += weights_.bias;
    const double leak = weights_.hyper.leak;
    x = (1.0 - leak) * x.array() + leak * z_.array().tanh();
    y_.noalias() = weights_.readout * features_;
    benchmark::DoNotOptimize(y_.data());
  }

 private:
  Weights weights_;
  Eigen::MatrixXd w_;
  Eigen::VectorXd features_, z_, y_;
};

void DenseStep(benchmark::State& state) {
  const int inputs = static_cast<int>(state.range(1));
  DenseNetwork network(
      SomeWeights(static_cast<int>(state.range(0)), inputs, static_cast<int>(state.range(2))));
  const Eigen::MatrixXd u = SomeInputs(inputs, 1024);
  Eigen::Index t = 0;
  for (auto _ : state) network.Step(u.col(t++ & 1023));
}
BENCHMARK(DenseStep)
    ->Args({470, 3, 1})
    ->Args({78, 6, 1})
    ->Args({76, 36, 12})
    ->Unit(benchmark::kMicrosecond);

double ThreadTime_us() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return 1e6 * static_cast<double>(now.tv_sec) + 1e-3 * static_cast<double>(now.tv_nsec);
}

// The default step beside the dense one and beside the fastest instruction set: each the least of
// many times of 20 steps, taken in turn, so that the ratios hold on a machine that does other work.
// Arguments: neurons, inputs, outputs, rows that share their columns.
void Ratio(benchmark::State& state) {
  constexpr int kSteps = 20;
  const int inputs = static_cast<int>(state.range(1));
  const Weights weights =
      SomeWeights(static_cast<int>(state.range(0)), inputs, static_cast<int>(state.range(2)),
                  static_cast<int>(state.range(3)));
  const Eigen::MatrixXd u = SomeInputs(inputs, kSteps);
  DenseNetwork dense(weights);
  Network by_default(weights);
  std::vector<Network> by_set;
  for (const simd::Instructions set : simd::kAllInstructions) {
    if (simd::Runs(set)) by_set.emplace_back(weights, set);
  }
  double dense_us = 1e9, default_us = 1e9, fastest_us = 1e9;
  const auto time = [&](auto& network, double* least_us) {
    const double start_us = ThreadTime_us();
    for (int t = 0; t < kSteps; ++t) {
      if constexpr (std::is_same_v<std::decay_t<decltype(network)>, DenseNetwork>) {
        network.Step(u.col(t));
      } else {
        benchmark::DoNotOptimize(network.Step(u.col(t)));
      }
    }
    *least_us = std::min(*least_us, (ThreadTime_us() - start_us) / kSteps);
  };
  for (auto _ : state) {
    time(dense, &dense_us);
    time(by_default, &default_us);
    for (Network& network : by_set) time(network, &fastest_us);
  }
  state.counters["default_us"] = default_us;
  state.counters["default/dense"] = default_us / dense_us;
  state.counters["default/fastest"] = default_us / fastest_us;
}
BENCHMARK(Ratio)
    ->ArgsProduct({{470}, {3}, {1}, {1, 4}})
    ->ArgsProduct({{78}, {6}, {1}, {1, 4}})
    ->ArgsProduct({{76}, {36}, {12}, {1, 4}})
    ->Iterations(200)
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
