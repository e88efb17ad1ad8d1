// Speed of the networks that learn by gradients: one step, one epoch.
//   cmake --preset release -DSINEW_BUILD_BENCH=ON
//   cmake --build build/release --target networks_bench && build/release/bin/networks_bench
// Goal on one core of a 3.5 GHz server processor: a step of the LSTM's cell (10 units) 0.25 us.
#include <benchmark/benchmark.h>

#include <cmath>

#include "reproduction/networks/adam.h"
#include "reproduction/networks/model.h"
#include "reproduction/networks/stepper.h"

namespace sinew::networks {
namespace {

Samples SomeSamples(int count) {
  Samples samples;
  samples.inputs.resize(3, count);
  samples.targets.resize(1, count);
  for (int t = 0; t < count; ++t) {
    for (int m = 0; m < 3; ++m) samples.inputs(m, t) = std::sin(0.013 * t * (m + 1));
    samples.targets(0, t) = std::sin(0.02 * t);
    samples.first.push_back(0);
    samples.train.push_back(t);
  }
  return samples;
}

Model SomeModel(const PublishedModel& plan) {
  Model model;
  model.name = plan.name;
  model.net = plan.net;
  model.parameters = Net<float>(plan.net, 1).parameters();
  model.inputs.assign(static_cast<std::size_t>(plan.net.inputs), "u");
  model.period_s = 0.0125;
  model.input = {Eigen::VectorXd::Zero(plan.net.inputs), Eigen::VectorXd::Ones(plan.net.inputs)};
  model.output = {Eigen::VectorXd::Zero(1), Eigen::VectorXd::Ones(1)};
  return model;
}

void Steps(benchmark::State& state, RecurrentMode mode) {
  const PublishedModel plan = Table62()[static_cast<std::size_t>(state.range(0))];
  Stepper stepper(SomeModel(plan), mode);
  const Eigen::MatrixXd u = SomeSamples(64).inputs;
  Eigen::Index t = 0;
  for (auto _ : state) benchmark::DoNotOptimize(stepper.Step(u.col(t++ & 63)));
  state.SetLabel(plan.name);
}

// Arguments: row of table 6.2 (0 LSTM, 1 GRU, 2 FFNN, 3 NNX).
void Cell(benchmark::State& state) { Steps(state, RecurrentMode::kCarry); }
BENCHMARK(Cell)->Arg(0)->Arg(1)->Unit(benchmark::kMicrosecond);
void Window(benchmark::State& state) { Steps(state, RecurrentMode::kWindow); }
BENCHMARK(Window)->DenseRange(0, 3)->Unit(benchmark::kMicrosecond);

// Arguments: row of table 6.2, instruction set.
void Epoch(benchmark::State& state) {
  const PublishedModel plan = Table62()[static_cast<std::size_t>(state.range(0))];
  const auto instructions = static_cast<simd::Instructions>(state.range(1));
  if (!simd::Runs(instructions)) {
    state.SkipWithError("instruction set not available here");
    return;
  }
  const Samples samples = SomeSamples(5600);
  const Data<float> data(samples);
  Net<float> net(plan.net, 1, instructions);
  Adam<float> adam({}, net.parameters().size());
  for (auto _ : state) {
    benchmark::DoNotOptimize(net.LossAndGradient(data, samples.train));
    adam.Step(net.gradient(), &net.parameters());
  }
  state.SetLabel(plan.name + " " + simd::Name(instructions));
}
BENCHMARK(Epoch)->ArgsProduct({{0, 1, 2, 3}, {0, 1, 2}})->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace sinew::networks

BENCHMARK_MAIN();
