#include "components/learn/esn/training.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace sinew::esn {
namespace {

constexpr long kFewestSamples = 10;

void CheckSequences(const std::vector<Sequence>& sequences) {
  if (sequences.empty()) throw std::invalid_argument("training: no sequence");
  const Eigen::Index inputs = sequences.front().inputs.cols();
  const Eigen::Index outputs = sequences.front().targets.cols();
  for (std::size_t s = 0; s < sequences.size(); ++s) {
    const Sequence& q = sequences[s];
    const std::string name = "training: sequence " + std::to_string(s);
    if (q.inputs.cols() != inputs || q.targets.cols() != outputs || inputs < 1 || outputs < 1) {
      throw std::invalid_argument(name + ": " + std::to_string(q.inputs.cols()) + " inputs and " +
                                  std::to_string(q.targets.cols()) + " targets, expected " +
                                  std::to_string(inputs) + " and " + std::to_string(outputs));
    }
    if (q.targets.rows() != q.inputs.rows() ||
        static_cast<Eigen::Index>(q.use.size()) != q.inputs.rows()) {
      throw std::invalid_argument(name + ": inputs, targets and use differ in length");
    }
    if (!q.inputs.allFinite() || !q.targets.allFinite()) {
      throw std::invalid_argument(name + ": holds a value that is not finite");
    }
  }
}

Eigen::Index WashoutSteps(double washout_s, double period_s) {
  return static_cast<Eigen::Index>(std::llround(washout_s / period_s));
}

// Mean and standard deviation of the columns over the training samples.
Normalisation Normalise(const std::vector<Sequence>& sequences, Eigen::MatrixXd Sequence::*member,
                        Eigen::Index washout, const char* what) {
  const Eigen::Index columns = (sequences.front().*member).cols();
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(columns);
  long count = 0;
  const auto each = [&](const auto& visit) {
    for (const Sequence& q : sequences) {
      for (Eigen::Index t = washout; t < q.inputs.rows(); ++t) {
        if (q.use[static_cast<std::size_t>(t)] == Use::kTrain)
          visit((q.*member).row(t).transpose());
      }
    }
  };
  each([&](const Eigen::VectorXd& row) {
    sum += row;
    ++count;
  });
  if (count < kFewestSamples) {
    throw std::invalid_argument(std::string("training: ") + std::to_string(count) + " samples of " +
                                what + " after the washout, expected at least " +
                                std::to_string(kFewestSamples));
  }
  Normalisation n;
  n.offset = sum / static_cast<double>(count);
  Eigen::VectorXd squares = Eigen::VectorXd::Zero(columns);
  each([&](const Eigen::VectorXd& row) { squares += (row - n.offset).cwiseAbs2(); });
  n.scale = (squares / static_cast<double>(count)).cwiseSqrt();
  for (Eigen::Index c = 0; c < columns; ++c) {
    // Below rounding of the mean the column does not vary.
    if (!(n.scale(c) > 1e-9 * std::max(1.0, std::abs(n.offset(c))))) n.scale(c) = 1.0;
  }
  return n;
}

}  // namespace

TrainingResult Train(const std::vector<Sequence>& sequences, const TrainingConfig& config) {
  CheckSequences(sequences);
  if (!(config.period_s > 0.0) || !(config.washout_s >= 0.0)) {
    throw std::invalid_argument("training: period_s must be above 0 and washout_s at least 0");
  }
  const Eigen::Index washout = WashoutSteps(config.washout_s, config.period_s);
  const int inputs = static_cast<int>(sequences.front().inputs.cols());
  const int outputs = static_cast<int>(sequences.front().targets.cols());

  TrainingResult result;
  Weights& weights = result.weights;
  weights = MakeWeights(config.hyper, inputs, outputs);
  weights.period_s = config.period_s;
  weights.input = Normalise(sequences, &Sequence::inputs, washout, "inputs");
  weights.output = Normalise(sequences, &Sequence::targets, washout, "targets");

  Network network(weights);
  NormalEquations equations(network.feature_count(), outputs);
  Eigen::VectorXd u(inputs);
  Eigen::VectorXd target(outputs);
  for (const Sequence& q : sequences) {
    network.Reset();
    for (Eigen::Index t = 0; t < q.inputs.rows(); ++t) {
      u = q.inputs.row(t);
      if (network.Step(u) != StepStatus::kOk) continue;  // cannot be: the inputs were checked
      if (t < washout || q.use[static_cast<std::size_t>(t)] != Use::kTrain) continue;
      target = (q.targets.row(t).transpose() - weights.output.offset)
                   .cwiseQuotient(weights.output.scale);
      if (!equations.Add(network.features(), target)) {
        throw std::invalid_argument("training: a sample is not finite");
      }
    }
  }

  double beta = 0.0;
  if (config.ridge_beta) {
    beta = *config.ridge_beta;
  } else {
    result.gcv = GeneralisedCrossValidation(
        equations, LogarithmicGrid(config.beta_lower, config.beta_upper, config.beta_count));
    const auto best =
        std::min_element(result.gcv.begin(), result.gcv.end(),
                         [](const GcvPoint& a, const GcvPoint& b) { return a.score < b.score; });
    beta = best->beta;
    result.effective_parameters = best->effective_parameters;
  }
  weights.ridge_beta = beta;
  // The normalisation of the targets goes into the weights of the features and of the constant.
  weights.readout = weights.output.scale.asDiagonal() * SolveRidge(equations, beta);
  weights.readout.col(0) += weights.output.offset;
  weights.Check();

  result.train = Evaluate(weights, sequences, Use::kTrain, config.washout_s);
  result.test = Evaluate(weights, sequences, Use::kTest, config.washout_s);
  return result;
}

Score Evaluate(const Weights& weights, const std::vector<Sequence>& sequences, Use use,
               double washout_s) {
  CheckSequences(sequences);
  Network network(weights);
  const Eigen::Index washout = WashoutSteps(washout_s, weights.period_s);
  const Eigen::Index outputs = weights.output_count();
  Eigen::VectorXd u(weights.input_count());
  Eigen::VectorXd error_squares = Eigen::VectorXd::Zero(outputs);
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(outputs);
  Eigen::VectorXd squares = Eigen::VectorXd::Zero(outputs);
  Score score;
  for (const Sequence& q : sequences) {
    network.Reset();
    for (Eigen::Index t = 0; t < q.inputs.rows(); ++t) {
      u = q.inputs.row(t);
      if (network.Step(u) != StepStatus::kOk) {
        throw std::invalid_argument("evaluation: " + std::to_string(u.size()) +
                                    " inputs, expected " + std::to_string(weights.input_count()));
      }
      if (t < washout || q.use[static_cast<std::size_t>(t)] != use) continue;
      // Relative to the training mean, so that the variance below does not cancel.
      const Eigen::VectorXd target = q.targets.row(t).transpose() - weights.output.offset;
      error_squares += (q.targets.row(t).transpose() - network.prediction()).cwiseAbs2();
      sum += target;
      squares += target.cwiseAbs2();
      ++score.samples;
    }
  }
  const double count = static_cast<double>(std::max(score.samples, 1L));
  score.mse = error_squares / count;
  const Eigen::VectorXd variance = squares / count - (sum / count).cwiseAbs2();
  score.normalised = score.mse.cwiseQuotient(variance.cwiseMax(1e-300));
  return score;
}

}  // namespace sinew::esn
