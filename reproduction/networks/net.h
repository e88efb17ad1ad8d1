// A network that learns by gradients: its error and the gradient of it, by tiles of samples.
//
//     L = mean over samples and outputs of (y - target)^2
//
// Backpropagation, through time for the recurrent ones, over the whole memory. S is float (for
// training) or double (for checking the gradient against differences); the same loops. The result
// depends on the seed alone, not on the instruction set.
//
// One thread at a time. Memory is taken in the constructor and by Predict.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "components/base/simd/instructions.h"
#include "reproduction/networks/architecture.h"
#include "reproduction/networks/samples.h"

namespace sinew::networks {

namespace internal {
template <typename S>
struct Kernel;
}  // namespace internal

// Samples in the numbers a net computes with.
template <typename S>
struct Data {
  using Matrix = Eigen::Matrix<S, Eigen::Dynamic, Eigen::Dynamic>;
  explicit Data(const Samples& samples)
      : inputs(samples.inputs.template cast<S>()),
        targets(samples.targets.template cast<S>()),
        first(samples.first) {}
  Matrix inputs;   // M x T
  Matrix targets;  // O x T
  std::vector<int> first;
};

template <typename S>
class Net {
 public:
  using Vector = Eigen::Matrix<S, Eigen::Dynamic, 1>;

  // Weights uniform by Glorot and Bengio (2010), biases 0, the forget gate's 1. Throws
  // std::invalid_argument as Architecture::Check(), or when the instruction set does not run here;
  // instructions: the fastest here if not given.
  Net(const Architecture& architecture, std::uint64_t seed,
      std::optional<simd::Instructions> instructions = {});

  // The error over the samples of `indices`, and its gradient into gradient(). Dropout is at work.
  // Throws std::invalid_argument when the data's inputs or targets do not fit.
  double LossAndGradient(const Data<S>& data, std::span<const int> indices);
  // The error alone, without dropout.
  double Loss(const Data<S>& data, std::span<const int> indices);
  // Into the columns `indices` of y (O x T), without dropout.
  void Predict(const Data<S>& data, std::span<const int> indices, Eigen::MatrixXd* y);

  Vector& parameters() { return parameters_; }
  const Vector& parameters() const { return parameters_; }
  const Vector& gradient() const { return gradient_; }
  const Architecture& architecture() const { return architecture_; }
  // What dropout leaves out next is drawn from here on; for tests.
  void SeedDropout(std::uint64_t seed) { dropout_state_ = seed; }

 private:
  void Check(const Data<S>& data) const;
  void Transpose();
  void Gather(const Data<S>& data, std::span<const int> indices);
  void Forward(bool training);
  void Backward();
  void DropOut(int layer);
  // The outputs of the tile, and the rows above whose derivative is wanted.
  S* Output() { return output_.data(); }

  Architecture architecture_;
  std::vector<Block> blocks_;
  const internal::Kernel<S>* kernel_;
  int lanes_;
  Vector parameters_;
  Vector gradient_;
  std::vector<S> sum_;         // of the gradient, lane by lane
  std::vector<S> transposed_;  // what Backward multiplies with
  std::vector<int> transposed_offset_;
  // Tiles. dense: values of every layer with a row of ones, and their derivatives.
  std::vector<std::vector<S>> value_, derivative_, mask_;
  // recurrent, step by step: [x, h, 1] or [x, 1] and [h, 1]; gates; cells.
  std::vector<S> x_, h_, gates_, from_h_, cell_, tanh_cell_, dh_, dc_;
  std::vector<S> output_, doutput_;
  std::uint64_t dropout_state_;
};

extern template class Net<float>;
extern template class Net<double>;

}  // namespace sinew::networks
