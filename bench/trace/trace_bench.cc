// Time to close the loop over the whole catalogue, beside a QR decomposition of as many rows.
//   cmake --preset release -DSINEW_BUILD_BENCH=ON && cmake --build build/release --target
//   trace_bench
// Goal on one core: 50 000 rows in 5 s.
#include <benchmark/benchmark.h>

#include <Eigen/QR>
#include <stdexcept>
#include <vector>

#include "components/model/trace/close_loop.h"
#include "tests/components/model/identify/synthetic.h"

namespace sinew::trace {
namespace {

constexpr double kRate_Hz = 250.0;
constexpr double kLongestGap_s = 0.25;

// A quarter of the rows in each of three training recordings and a held-out one, with an effect
// that the model lacks; both encoders.
void CloseLoopOverTheCatalogue(benchmark::State& state) {
  const actuator::JointModel model = identify::SyntheticModel();
  actuator::JointModel truth = model;
  truth.terms.push_back(identify::TermOf("quadratic_viscous", {0.4}, truth.constants));
  std::vector<types::Run> runs;
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    runs.push_back(identify::SyntheticRun(
        truth, {.rate_Hz = kRate_Hz,
                .duration_s = static_cast<double>(state.range(0)) / 4.0 / kRate_Hz,
                .seed = seed,
                .noise_A = 0.1,
                .motor_position = true}));
  }
  const std::vector<types::Run> held_out = {runs.back()};
  runs.pop_back();
  for (auto _ : state) {
    const LoopResult result = CloseLoop(runs, held_out, model, kLongestGap_s, {});
    if (result.trace.verdict != Verdict::kEffect) {
      throw std::runtime_error("the effect was not found, expected the whole search to run");
    }
  }
}
BENCHMARK(CloseLoopOverTheCatalogue)->Arg(12500)->Arg(50000)->Unit(benchmark::kMillisecond);

// The unit of work of every fit.
void DecomposeAsManyRows(benchmark::State& state) {
  const Eigen::MatrixXd X = Eigen::MatrixXd::Random(state.range(0), 100);
  for (auto _ : state) benchmark::DoNotOptimize(Eigen::HouseholderQR<Eigen::MatrixXd>(X));
}
BENCHMARK(DecomposeAsManyRows)->Arg(12500)->Arg(50000)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace sinew::trace

BENCHMARK_MAIN();
