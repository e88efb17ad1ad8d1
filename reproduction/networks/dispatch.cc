#include "reproduction/networks/dispatch.h"

#include <vector>

#include "components/base/simd/fastest.h"

namespace sinew::networks::internal {
namespace {

// A recurrent cell of 10 units with 4 gates and 3 inputs.
constexpr int kUnits = 10;
constexpr int kGates = 4 * kUnits;
constexpr int kIn = 3 + kUnits + 1;

}  // namespace

template <typename S>
simd::Instructions FastestTraining() {
  static const simd::Instructions kFastest = [] {
    constexpr int kLanes = 2 * kLanesOf<S>;
    constexpr int kCells = kUnits * kLanes;
    const std::vector<S> weights(kGates * kIn, S(0.1)), x(kIn * kLanes, S(0.1)), c(kCells, S(0.1));
    std::vector<S> gates(kGates * kLanes), sum(kGates * kIn * kLanesOf<S>, S(0));
    std::vector<S> next(kCells), tanh_next(kCells), h(kCells);
    return simd::Fastest([&](simd::Instructions set) {
      const Kernel<S>& kernel = KernelFor<S>(set);
      kernel.affine(weights.data(), x.data(), gates.data(), kGates, kIn, kLanes, false);
      kernel.lstm(gates.data(), c.data(), next.data(), tanh_next.data(), h.data(), kCells);
      kernel.outer(gates.data(), x.data(), sum.data(), kGates, kIn, kLanes, 1, 0, 0);
    });
  }();
  return kFastest;
}

template simd::Instructions FastestTraining<float>();
template simd::Instructions FastestTraining<double>();

simd::Instructions FastestSample() {
  static const simd::Instructions kFastest = [] {
    constexpr int kPadded = kLanesOf<float>;  // of kUnits
    constexpr int kRows = 4 * kPadded;
    constexpr int kSteps = 12;  // one takes a tenth of a microsecond
    const std::vector<float> columns(kRows * kIn, 0.1F), x(kIn, 0.1F), c(kPadded, 0.1F);
    std::vector<float> gates(kRows), next(kPadded), tanh_next(kPadded), h(kPadded);
    return simd::Fastest([&](simd::Instructions set) {
      const Kernel<float>& kernel = KernelFor<float>(set);
      for (int step = 0; step < kSteps; ++step) {
        kernel.columns(columns.data(), x.data(), gates.data(), kRows, kIn);
        kernel.lstm(gates.data(), c.data(), next.data(), tanh_next.data(), h.data(), kPadded);
      }
    });
  }();
  return kFastest;
}

}  // namespace sinew::networks::internal
