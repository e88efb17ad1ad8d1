// A trained model, one sample at a time: what a loop would run.
//
// One thread at a time. Memory is taken in the constructor only.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <vector>

#include "components/learn/esn/network.h"
#include "reproduction/networks/model.h"

namespace sinew::networks {

enum class RecurrentMode {
  kWindow,  // as trained: from a zero state over the last `memory` samples at every step
  kCarry,   // one cell a step, the state carried on: faster, and not what was trained
};

class Stepper {
 public:
  // instructions: the fastest here if not given. Throws std::invalid_argument as Model::Check(),
  // for several outputs, or when the instruction set does not run here.
  explicit Stepper(const Model& model, RecurrentMode mode = RecurrentMode::kWindow,
                   std::optional<simd::Instructions> instructions = {});

  // The next sample is the first of a sequence.
  void Reset() noexcept;
  // u: the measured inputs in their own units. y in the target's unit; inputs that are not finite
  // or of the wrong number leave the state as it is and give not a number.
  double Step(const Eigen::Ref<const Eigen::VectorXd>& u) noexcept;

 private:
  struct Layer {
    int in = 0;
    int rows = 0;  // padded
    std::vector<float> columns;
  };

  double StepNet() noexcept;
  void Cell(const float* u) noexcept;

  Model model_;
  RecurrentMode mode_;
  const internal::Kernel<float>* kernel_;
  std::unique_ptr<esn::Network> network_;
  std::vector<Layer> layers_;
  int measured_;
  int inputs_;     // with the linear block's output
  int units_ = 0;  // padded
  bool started_ = false;
  std::vector<double> linear_window_;  // taps x inputs of the linear block, newest first
  Eigen::VectorXd now_;                // normalised inputs, with the linear block's output
  std::vector<float> window_;          // memory x inputs, oldest first
  std::vector<float> x_, h_, c_, c_next_, tanh_c_, gates_, from_h_;
  std::vector<std::vector<float>> value_;
};

}  // namespace sinew::networks
