// The echo state network in the published form: a readout of the state alone.
//
//     y(t) = W_out x(t)            (4.42), N parameters an output as in (6.5), (6.8), (6.16)
//
// The reservoir is that of components/learn/esn (4.38)-(4.40), the readout is by ridge regression
// (4.41) with a given strength, or with the best of 20 by generalised cross-validation. The state
// starts from 0 in every sequence; its first `washout` samples are not used for the fit.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "components/learn/esn/ridge.h"
#include "components/learn/esn/weights.h"
#include "reproduction/networks/samples.h"

namespace sinew::networks {

struct ReservoirConfig {
  esn::Hyperparameters hyper;
  std::optional<double> ridge_beta;  // nothing: the best of beta_count by the choice below
  // By the error on validation samples, as the gradient nets stop, instead of generalised
  // cross-validation, which takes neighbouring samples for independent ones.
  bool beta_by_validation = false;
  double beta_lower = 1e-6;
  double beta_upper = 1e4;
  int beta_count = 20;
  int washout = 40;  // samples
};

struct ReservoirModel {
  esn::Weights weights;     // without a readout of its own
  Eigen::MatrixXd readout;  // O x N
  double ridge_beta = 0.0;
  std::vector<esn::GcvPoint> gcv;  // empty without cross-validation

  int parameter_count() const { return static_cast<int>(readout.size()); }
};

// The reservoir alone, for samples that are normalised already.
esn::Weights MakeReservoir(const esn::Hyperparameters& hyper, int inputs, int outputs);
// N x T.
Eigen::MatrixXd ReservoirStates(const esn::Weights& reservoir, const Samples& samples);

// Throws std::invalid_argument as esn::MakeWeights and the ridge regression.
ReservoirModel FitReadout(const esn::Weights& reservoir, const Eigen::MatrixXd& states,
                          const Samples& samples, const ReservoirConfig& config);

// The three of them; predicted (may be null) becomes O x T.
ReservoirModel FitReservoir(const Samples& samples, const ReservoirConfig& config,
                            Eigen::MatrixXd* predicted);

}  // namespace sinew::networks
