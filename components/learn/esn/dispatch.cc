#include "components/learn/esn/dispatch.h"

#include <vector>

#include "components/base/simd/fastest.h"

namespace sinew::esn::internal {

const Kernel& KernelFor(simd::Instructions instructions) noexcept {
#if defined(__x86_64__)
  if (instructions == simd::Instructions::kAvx512) return kAvx512Kernel;
  if (instructions == simd::Instructions::kAvx2) return kAvx2Kernel;
#endif
  (void)instructions;
  return kPortableKernel;
}

namespace {

using StepKernel = void (*Kernel::*)(const StepArguments&) noexcept;

simd::Instructions FastestOf(StepKernel step) {
  constexpr int kRows = 240;
  constexpr int kEntries = 24;
  constexpr int kInputs = 3;
  std::vector<std::int32_t> column(kRows * kEntries);
  for (std::size_t i = 0; i < column.size(); ++i) {
    column[i] = static_cast<std::int32_t>(i * 97 % kRows);  // apart, as random columns are
  }
  const std::vector<double> value(kRows * kEntries, 0.01), bias(kRows, 0.1),
      input_weight(kRows * kInputs, 0.1), input(kInputs, 0.5);
  std::vector<double> state(kRows, 0.0), work(kRows);
  StepArguments arguments;
  arguments.rows = kRows;
  arguments.entries = kEntries;
  arguments.inputs = kInputs;
  arguments.column = column.data();
  arguments.value = value.data();
  arguments.bias = bias.data();
  arguments.input_weight = input_weight.data();
  arguments.input = input.data();
  arguments.leak = 0.1;
  arguments.state = state.data();
  arguments.work = work.data();
  return simd::Fastest([&](simd::Instructions set) { (KernelFor(set).*step)(arguments); });
}

}  // namespace

simd::Instructions FastestStep() {
  static const simd::Instructions kFastest = FastestOf(&Kernel::step);
  return kFastest;
}

simd::Instructions FastestSharedStep() {
  static const simd::Instructions kFastest = FastestOf(&Kernel::step_shared);
  return kFastest;
}

simd::Instructions FastestGram() {
  static const simd::Instructions kFastest = [] {
    constexpr int kColumns = 2 * kPanelColumns;
    const std::vector<double> panels(kColumns * kPanelSamples, 0.1);
    std::vector<double> gram(kColumns * kColumns, 0.0);
    return simd::Fastest(
        [&](simd::Instructions set) { KernelFor(set).gram(panels.data(), kColumns, gram.data()); });
  }();
  return kFastest;
}

int Padded(int count, int block) noexcept { return (count + block - 1) / block * block; }

}  // namespace sinew::esn::internal
