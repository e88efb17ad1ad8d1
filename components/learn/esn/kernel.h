// The inner loops of the echo state network, each compiled for several instruction sets
// (components/base/simd). Plain pointers on purpose: the kernel files include nothing that could
// leak wide instructions elsewhere.
#pragma once

#include <cstdint>

namespace sinew::esn::internal {

inline constexpr int kRowBlock = 16;      // reservoir rows are padded to a multiple of this
inline constexpr int kSharedRows = 4;     // rows of a group that has the same columns (step_shared)
inline constexpr int kPanelColumns = 16;  // columns of a panel of samples
inline constexpr int kPanelSamples = 128;

struct StepArguments {
  int rows = 0;     // padded
  int entries = 0;  // of every row of W
  int inputs = 0;
  // W by blocks of kRowBlock rows: entry j of the block's rows side by side.
  const std::int32_t* column =
      nullptr;                    // rows * entries; step_shared: rows / kSharedRows * entries
  const double* value = nullptr;  // rows * entries
  const double* bias = nullptr;   // rows
  const double* input_weight = nullptr;  // inputs x rows: the weights of one input side by side
  const double* input = nullptr;         // inputs
  double leak = 0.0;
  double* state = nullptr;  // rows; read and overwritten
  double* work = nullptr;   // rows
};

struct Kernel {
  // state = (1 - leak) state + leak tanh(W state + W_in u + b) (4.39)
  void (*step)(const StepArguments&) noexcept;
  // The same, with the same bits, where the rows of a group of kSharedRows have the same columns:
  // one load of the state serves all of them.
  void (*step_shared)(const StepArguments&) noexcept;
  // values = tanh(values); count a multiple of 8.
  void (*tanh)(double* values, int count) noexcept;
  // gram += X' X, upper block triangle only. panels: columns / 16 panels, each kPanelSamples x 16;
  // columns a multiple of 16; gram: columns x columns, row by row.
  void (*gram)(const double* panels, int columns, double* gram) noexcept;
};

extern const Kernel kPortableKernel;
extern const Kernel kAvx2Kernel;
extern const Kernel kAvx512Kernel;

}  // namespace sinew::esn::internal
