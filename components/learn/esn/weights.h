// Everything that defines a trained echo state network: what a weights file holds.
//
//   symbol  here              shape            source
//   N       neurons
//   M       inputs
//   O       outputs
//   W       reservoir         N x N, sparse    (4.38)
//   W_in    input_weight      N x M            ~ N(0, alpha), alpha a variance
//   b       bias              N                ~ N(0, 1)
//   W_out   readout           O x (1 + M + N)  (4.41)
//   rho     spectral_radius
//   tau     leak
//   beta    ridge_beta
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "components/learn/esn/signals.h"

namespace sinew::esn {

struct Hyperparameters {
  int neurons = 78;
  double spectral_radius = 0.95;  // rho > 0; above 1 the echo state property is usual, not assured
  double input_variance = 0.1;    // alpha > 0, of normalised inputs
  double density = 0.1;  // share of W that is not zero, in (0, 1]: round(density N) entries a row
  double leak = 0.066;   // tau in (0, 1]
  // Consecutive rows of W with the same columns: 4, or 1 (every row draws its own, as published),
  // with which a step takes twice the time (docs/decisions/0011-vector-kernels.md). Files do not
  // keep it: the columns show it.
  int shared_rows = 4;
  double input_limit = 6.0;  // normalised inputs are clipped here, > 0: a wild reference stays tame
  std::uint64_t seed = 1;

  // Throws std::invalid_argument naming the value that cannot be.
  void Check() const;
};

// Sparse square matrix whose rows have equally many entries (ELL).
struct EllMatrix {
  int rows = 0;
  int entries = 0;            // of each row
  std::vector<int> column;    // rows x entries, row by row, ascending within a row
  std::vector<double> value;  // as column

  Eigen::MatrixXd Dense() const;
};

// normalised = (value - offset) / scale
struct Normalisation {
  Eigen::VectorXd offset;
  Eigen::VectorXd scale;
};

struct Weights {
  Hyperparameters hyper;
  double period_s = 0.0;      // of a step, in training and in use; > 0
  std::vector<Input> inputs;  // what the columns of input_weight are, in order
  std::string network;        // "sea", "pea" or another word for what it was trained for
  std::string target;         // name of the trained quantity with its unit, e.g. "drive_torque_Nm"
  EllMatrix reservoir;
  Eigen::MatrixXd input_weight;
  Eigen::VectorXd bias;
  Normalisation input;      // M each
  Normalisation output;     // O each: of the training targets. Already inside readout.
  Eigen::MatrixXd readout;  // features -> target in its own unit
  double ridge_beta = 0.0;
  std::string training_data_hash;  // of the recordings it was trained on; empty: none

  int neurons() const { return hyper.neurons; }
  int input_count() const { return static_cast<int>(input_weight.cols()); }
  int output_count() const { return static_cast<int>(readout.rows()); }
  int feature_count() const { return 1 + input_count() + neurons(); }

  // Throws std::invalid_argument: shapes that do not fit each other, columns out of range or not
  // ascending, values that are not finite, scales that are not positive.
  void Check() const;
};

// A reservoir of random weights without a readout (zero). The numbers come from hyper.seed in this
// order: row by row of W its columns (of the first row of those that share them), then its values;
// W_in row by row; b. So W does not depend on
// the inputs. W is scaled by all its eigenvalues to the spectral radius. Throws
// std::invalid_argument: hyper-parameters, no inputs, or a W whose eigenvalues are all zero.
Weights MakeWeights(const Hyperparameters& hyper, int inputs, int outputs);

// The largest absolute eigenvalue.
double SpectralRadius(const EllMatrix& matrix);

}  // namespace sinew::esn
