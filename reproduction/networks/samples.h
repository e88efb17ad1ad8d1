// Samples that a network learns from: inputs and targets of sequences, normalised, one after the
// other, and which of them train, validate or test.
//
// Normalised by mean and standard deviation of the training samples: value = (own - offset) /
// scale. A mean squared error of normalised targets is a share of the variance of the training
// targets: every MSE of this module is given so, and is the same whatever the unit.
//
// Pure data; any thread.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "components/learn/esn/training.h"
#include "components/learn/esn/weights.h"

namespace sinew::networks {

struct Samples {
  Eigen::MatrixXd inputs;   // M x T, normalised
  Eigen::MatrixXd targets;  // O x T, normalised
  std::vector<int> first;   // T: the first sample of the sequence that this one belongs to
  std::vector<int> train;   // indices, ascending
  std::vector<int> validation;
  std::vector<int> test;
  esn::Normalisation input;
  esn::Normalisation output;

  int count() const { return static_cast<int>(inputs.cols()); }
};

// validation_share: of every unbroken piece of training samples its last share is taken for
// validation, with `gap` samples before it left out; 0 takes none. Throws std::invalid_argument:
// shapes, values that are not finite, fewer than 10 training samples, share not in [0, 0.9].
Samples MakeSamples(const std::vector<esn::Sequence>& sequences, double validation_share = 0.0,
                    int gap = 0);

// The same samples with other rows of inputs.
Samples SelectInputs(const Samples& samples, const std::vector<int>& rows);
// With one more input row.
Samples AppendInput(const Samples& samples, const Eigen::VectorXd& row);

// Mean squared difference over the samples of `indices`, of normalised values. predicted: O x T.
double MeanSquare(const Samples& samples, const Eigen::MatrixXd& predicted,
                  const std::vector<int>& indices);

}  // namespace sinew::networks
