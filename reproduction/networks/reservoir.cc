#include "reproduction/networks/reservoir.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <limits>
#include <stdexcept>

#include "components/learn/esn/network.h"

namespace sinew::networks {
namespace {

double BestByValidation(esn::NormalEquations* equations, const Eigen::MatrixXd& states,
                        const Samples& samples, const ReservoirConfig& config) {
  if (samples.validation.empty()) {
    throw std::invalid_argument("reservoir: a choice by validation without validation samples");
  }
  // X X' = V L V': every strength from one decomposition.
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(equations->FeatureProducts());
  const Eigen::ArrayXd lambda = eigen.eigenvalues().array().max(0.0);
  const Eigen::MatrixXd cross = eigen.eigenvectors().transpose() * equations->CrossProducts();
  const Eigen::Index count = static_cast<Eigen::Index>(samples.validation.size());
  Eigen::MatrixXd seen(states.rows(), count), target(samples.targets.rows(), count);
  for (Eigen::Index k = 0; k < count; ++k) {
    const int t = samples.validation[static_cast<std::size_t>(k)];
    seen.col(k) = states.col(t);
    target.col(k) = samples.targets.col(t);
  }
  const Eigen::MatrixXd projected = eigen.eigenvectors().transpose() * seen;
  double best = config.beta_lower;
  double least = std::numeric_limits<double>::infinity();
  for (const double beta :
       esn::LogarithmicGrid(config.beta_lower, config.beta_upper, config.beta_count)) {
    const Eigen::MatrixXd weights = (1.0 / (lambda + beta)).matrix().asDiagonal() * cross;
    const double error = (weights.transpose() * projected - target).squaredNorm();
    if (error < least) {
      least = error;
      best = beta;
    }
  }
  return best;
}

}  // namespace

esn::Weights MakeReservoir(const esn::Hyperparameters& hyper, int inputs, int outputs) {
  esn::Weights weights = esn::MakeWeights(hyper, inputs, outputs);
  weights.period_s = 1.0;  // a sample
  return weights;
}

Eigen::MatrixXd ReservoirStates(const esn::Weights& reservoir, const Samples& samples) {
  esn::Network network(reservoir);
  Eigen::MatrixXd states(network.neurons(), samples.count());
  for (int t = 0; t < samples.count(); ++t) {
    if (samples.first[static_cast<std::size_t>(t)] == t) network.Reset();
    if (network.Step(samples.inputs.col(t)) != esn::StepStatus::kOk) {
      throw std::invalid_argument("reservoir: inputs of another number, or not finite");
    }
    states.col(t) = network.state();
  }
  return states;
}

ReservoirModel FitReadout(const esn::Weights& reservoir, const Eigen::MatrixXd& states,
                          const Samples& samples, const ReservoirConfig& config) {
  const int outputs = static_cast<int>(samples.targets.rows());
  esn::NormalEquations equations(static_cast<int>(states.rows()), outputs);
  for (const int t : samples.train) {
    if (t - samples.first[static_cast<std::size_t>(t)] < config.washout) continue;
    if (!equations.Add(states.col(t), samples.targets.col(t))) {
      throw std::invalid_argument("reservoir: a state or target is not finite");
    }
  }
  ReservoirModel model;
  model.weights = reservoir;
  if (config.ridge_beta) {
    model.ridge_beta = *config.ridge_beta;
  } else if (config.beta_by_validation) {
    model.ridge_beta = BestByValidation(&equations, states, samples, config);
  } else {
    model.gcv = esn::GeneralisedCrossValidation(
        equations, esn::LogarithmicGrid(config.beta_lower, config.beta_upper, config.beta_count));
    model.ridge_beta =
        std::min_element(model.gcv.begin(), model.gcv.end(), [](const auto& a, const auto& b) {
          return a.score < b.score;
        })->beta;
  }
  model.readout = esn::SolveRidge(equations, model.ridge_beta);
  return model;
}

ReservoirModel FitReservoir(const Samples& samples, const ReservoirConfig& config,
                            Eigen::MatrixXd* predicted) {
  const esn::Weights reservoir =
      MakeReservoir(config.hyper, static_cast<int>(samples.inputs.rows()),
                    static_cast<int>(samples.targets.rows()));
  const Eigen::MatrixXd states = ReservoirStates(reservoir, samples);
  ReservoirModel model = FitReadout(reservoir, states, samples, config);
  if (predicted != nullptr) *predicted = model.readout * states;
  return model;
}

}  // namespace sinew::networks
