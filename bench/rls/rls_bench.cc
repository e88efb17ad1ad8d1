// Speed of recursive least squares, beside the textbook recursion with a full covariance.
//   cmake --preset release -DSINEW_BUILD_BENCH=ON && cmake --build build/release --target rls_bench
// Goal on one core of a 3.5 GHz server processor: 76 features x 12 outputs in 1.8 us.
#include <benchmark/benchmark.h>

#include <cmath>

#include "components/learn/rls/rls.h"

namespace sinew::rls {
namespace {

Eigen::MatrixXd SomeFeatures(int features) {
  Eigen::MatrixXd phi(features, 512);
  for (int t = 0; t < 512; ++t) {
    for (int i = 0; i < features; ++i) phi(i, t) = std::sin(0.1 * t * (1.0 + 0.03 * i) + i);
  }
  return phi;
}

// Arguments: features, outputs, instruction set.
void Update(benchmark::State& state) {
  const int features = static_cast<int>(state.range(0));
  const int outputs = static_cast<int>(state.range(1));
  const auto instructions = static_cast<simd::Instructions>(state.range(2));
  if (!simd::Runs(instructions)) {
    state.SkipWithError("instruction set not available here");
    return;
  }
  RecursiveLeastSquares rls(Config{}, Eigen::MatrixXd::Zero(outputs, features), instructions);
  const Eigen::MatrixXd phi = SomeFeatures(features);
  const Eigen::VectorXd y = Eigen::VectorXd::Constant(outputs, 0.3);
  Eigen::Index t = 0;
  for (auto _ : state) benchmark::DoNotOptimize(rls.Update(phi.col(t++ & 511), y));
  state.SetLabel(simd::Name(instructions));
}
void UpdateArguments(benchmark::internal::Benchmark* b) {
  for (const int set : {0, 1, 2}) b->Args({76, 12, set})->Args({85, 1, set})->Args({474, 1, set});
}
BENCHMARK(Update)->Apply(UpdateArguments)->Unit(benchmark::kMicrosecond);

void TextbookUpdate(benchmark::State& state) {
  const int features = static_cast<int>(state.range(0));
  const int outputs = static_cast<int>(state.range(1));
  const Eigen::MatrixXd phi = SomeFeatures(features);
  const Eigen::VectorXd y = Eigen::VectorXd::Constant(outputs, 0.3);
  Eigen::MatrixXd p = Eigen::MatrixXd::Identity(features, features);
  Eigen::MatrixXd w = Eigen::MatrixXd::Zero(outputs, features);
  Eigen::VectorXd g(features);
  Eigen::VectorXd e(outputs);
  Eigen::Index t = 0;
  for (auto _ : state) {
    const auto x = phi.col(t++ & 511);
    g.noalias() = p * x;
    const double alpha = 1.0 / (0.999 + x.dot(g));
    e.noalias() = y - w * x;
    w.noalias() += (alpha * e) * g.transpose();
    p.noalias() -= (alpha * g) * g.transpose();
    p *= 1.0 / 0.999;
    p.diagonal().array() = p.diagonal().array().min(1e3);
    benchmark::DoNotOptimize(p.data());
  }
}
BENCHMARK(TextbookUpdate)
    ->Args({76, 12})
    ->Args({85, 1})
    ->Args({474, 1})
    ->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace sinew::rls

BENCHMARK_MAIN();
