// Trains a network on sequences of inputs and targets.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "components/learn/esn/network.h"
#include "components/learn/esn/ridge.h"
#include "components/learn/esn/weights.h"

namespace sinew::esn {

enum class Use : unsigned char { kNone, kTrain, kTest };

// One unbroken sequence at the network's period: the state runs through all of it, starting from 0,
// and the readout is fitted and assessed on the samples that `use` names.
struct Sequence {
  Eigen::MatrixXd inputs;   // T x M, own units
  Eigen::MatrixXd targets;  // T x O
  std::vector<Use> use;     // T
};

struct TrainingConfig {
  Hyperparameters hyper;
  double washout_s = 0.5;  // the start of every sequence, used for nothing; >= 0
  double period_s = 1.0 / 240.0;
  std::optional<double> ridge_beta;  // nothing: the best of the grid by GCV
  double beta_lower = 1e-6;
  double beta_upper = 1e4;
  int beta_count = 20;
};

struct Score {
  long samples = 0;
  Eigen::VectorXd mse;         // per output, in the target's unit squared
  Eigen::VectorXd normalised;  // mse / variance of the targets of these samples
};

struct TrainingResult {
  Weights weights;
  Score train;
  Score test;                         // samples 0 when there is nothing to test on
  std::vector<GcvPoint> gcv;          // empty when ridge_beta was given
  double effective_parameters = 0.0;  // 0 when ridge_beta was given
};

// Normalises inputs and targets by mean and standard deviation of the training samples (an input
// that does not vary keeps scale 1), makes a reservoir from the seed, and fits the readout. Throws
// std::invalid_argument: shapes, values that are not finite, fewer training samples than 10.
TrainingResult Train(const std::vector<Sequence>& sequences, const TrainingConfig& config);

// Runs a network over the sequences and scores the samples of a use after the washout.
Score Evaluate(const Weights& weights, const std::vector<Sequence>& sequences, Use use,
               double washout_s);

}  // namespace sinew::esn
