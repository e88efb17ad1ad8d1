// An echo state network, stepped once a tick.
//
//   u_n(t) = clip((u(t) - offset) / scale, +-input_limit)
//
//   x(t) = (1 - tau) x(t-1) + tau tanh(W x(t-1) + W_in u_n(t) + b)      (4.39)
//
//   y(t) = W_out [1, u_n(t), x(t)]                                      (4.42)
//
// The source's readout sees x alone; the constant and the inputs are added (Lukosevicius 2012, eq.
// 4), so that the network holds the linear model as a special case. Symbols: weights.h.
//
// One thread at a time. Memory is taken in the constructor only.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "components/base/simd/instructions.h"
#include "components/learn/esn/weights.h"

namespace sinew::types {
class StateArchive;
}

namespace sinew::esn {

enum class [[nodiscard]] StepStatus{
    kOk,
    kBadInput,  // an input was not finite or of the wrong size: state kept, prediction zero
};

// A state's change in a step that no longer shows: of states of up to 1.
inline constexpr double kSettled = 1e-9;
// A reservoir that does not come to rest (spectral radius above 1) stops here: 8 s at 240 Hz.
inline constexpr int kSettleSteps = 2000;

class Network {
 public:
  // instructions: the fastest here if not given. Throws std::invalid_argument as Weights::Check(),
  // or when the instruction set does not run here.
  explicit Network(const Weights& weights, std::optional<simd::Instructions> instructions = {});

  // x = 0, prediction zero.
  void Reset() noexcept;

  // u: M inputs in their own units.
  StepStatus Step(const Eigen::Ref<const Eigen::VectorXd>& u) noexcept;

  // Steps with one input until no state changes by more than kSettled, at most kSettleSteps times:
  // the network as if the input had always been this one. Else the way there from x = 0 would be
  // part of the first predictions; training leaves it out as washout.
  StepStatus Settle(const Eigen::Ref<const Eigen::VectorXd>& u) noexcept;

  // Takes another W_out (O x (1 + M + N)). False, and nothing changes: wrong shape or not finite.
  [[nodiscard]] bool SetReadout(const Eigen::Ref<const Eigen::MatrixXd>& readout) noexcept;

  // y of the last step, in the target's unit; zero after kBadInput.
  const Eigen::VectorXd& prediction() const noexcept { return prediction_; }
  // [1, u_n, x] of the last good step.
  Eigen::Ref<const Eigen::VectorXd> features() const noexcept {
    return features_.head(feature_count_);
  }
  const Eigen::MatrixXd& readout() const noexcept { return readout_; }
  // x, for tests and for starting elsewhere than at 0.
  Eigen::Ref<const Eigen::VectorXd> state() const noexcept {
    return features_.segment(1 + inputs_, neurons_);
  }
  void SetState(const Eigen::Ref<const Eigen::VectorXd>& state) noexcept;
  void Exchange(types::StateArchive& archive);  // types/state_archive.h

  int input_count() const noexcept { return inputs_; }
  int output_count() const noexcept { return static_cast<int>(readout_.rows()); }
  int feature_count() const noexcept { return feature_count_; }
  int neurons() const noexcept { return neurons_; }

 private:
  int neurons_;
  int inputs_;
  int feature_count_;
  int rows_;  // neurons_, padded
  int entries_;
  double leak_;
  double input_limit_;
  std::vector<std::int32_t> column_;
  std::vector<double> value_;
  std::vector<double> bias_;
  std::vector<double> input_weight_;
  std::vector<double> work_;
  Eigen::VectorXd offset_;
  Eigen::VectorXd scale_;
  Eigen::VectorXd features_;  // padded behind x
  Eigen::VectorXd settling_;  // x of the step before, in Settle
  Eigen::MatrixXd readout_;
  Eigen::VectorXd prediction_;
  bool shared_;  // groups of rows have the same columns
  simd::Instructions instructions_;
};

// values = tanh(values), with the step's own approximation. The error against std::tanh is at most
// 5 units in the last place; +-1 beyond |x| = 20; not a number stays not a number.
// For tests; allocates.
void Tanh(Eigen::Ref<Eigen::VectorXd> values, simd::Instructions instructions);

}  // namespace sinew::esn
