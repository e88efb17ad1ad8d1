// A trained model of any of the kinds: what `Fit` makes, `Predict` and Stepper use, and a file
// holds.
//
// Thread: Fit and Predict may run in several threads on the same samples.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "reproduction/networks/linear.h"
#include "reproduction/networks/net.h"
#include "reproduction/networks/published.h"
#include "reproduction/networks/reservoir.h"
#include "reproduction/networks/training.h"

namespace sinew::networks {

struct Model {
  std::string name;
  std::string task;                 // "sea", "pea", "force"; empty: of nobody's
  std::vector<std::string> inputs;  // names with units, in order, of the measured inputs
  std::string target;               // name with its unit
  double period_s = 0.0;            // of a sample
  esn::Normalisation input;         // of the measured inputs
  esn::Normalisation output;
  Method method = Method::kNet;
  std::optional<LinearModel> linear;  // the model itself, or the linear block of a Wiener model
  Architecture net;                   // kNet
  Eigen::VectorXf parameters;         // kNet
  esn::Weights reservoir;             // kReservoir
  Eigen::MatrixXd readout;            // kReservoir, O x N
  double ridge_beta = 0.0;
  std::uint64_t seed = 0;
  std::string training_data_hash;

  // Of what was trained: linear coefficients, weights and biases, readout.
  int parameter_count() const;
  bool wiener() const { return method != Method::kLinear && linear.has_value(); }
  // Throws std::invalid_argument: parts that do not fit each other, values that are not finite.
  void Check() const;
};

struct FitResult {
  Model model;
  Eigen::MatrixXd predicted;  // O x T, normalised
  double train_mse = 0.0;     // normalised: a share of the variance of the training targets
  double validation_mse = 0.0;
  double test_mse = 0.0;
  TrainOutcome training;  // kNet
};

// linear_rows: inputs of the linear model or block. The seed is of initial weights, order of
// samples, dropout and reservoir. Throws std::invalid_argument.
FitResult Fit(const PublishedModel& plan, const Samples& samples,
              const std::vector<int>& linear_rows, std::uint64_t seed,
              const std::function<bool(const TrainProgress&)>& report = {});

// O x T, normalised, of samples that are normalised as the model's own.
Eigen::MatrixXd Predict(const Model& model, const Samples& samples);

}  // namespace sinew::networks
