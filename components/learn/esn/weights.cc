#include "components/learn/esn/weights.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>

#include "components/base/types/joints.h"
#include "components/base/types/require.h"
#include "components/learn/esn/normal.h"

namespace sinew::esn {
using types::Require;

namespace {

std::string Shape(Eigen::Index rows, Eigen::Index columns) {
  return std::to_string(rows) + " x " + std::to_string(columns);
}

void RequireShape(const Eigen::MatrixXd& matrix, Eigen::Index rows, Eigen::Index columns,
                  const std::string& name) {
  Require(matrix.rows() == rows && matrix.cols() == columns,
          name + ": shape " + Shape(matrix.rows(), matrix.cols()) + ", expected " +
              Shape(rows, columns));
  Require(matrix.allFinite(), name + ": holds a value that is not finite");
}

void RequireNormalisation(const Normalisation& n, Eigen::Index size, const std::string& name) {
  RequireShape(n.offset, size, 1, name + ".offset");
  RequireShape(n.scale, size, 1, name + ".scale");
  Require((n.scale.array() > 0.0).all(), name + ".scale: not positive everywhere");
}

}  // namespace

void Hyperparameters::Check() const {
  Require(neurons >= 1 && neurons <= 100000,
          "neurons: " + std::to_string(neurons) + ", expected 1 .. 100000");
  Require(spectral_radius > 0.0, "spectral_radius", spectral_radius, "a number above 0");
  Require(input_variance > 0.0, "input_variance", input_variance, "a number above 0");
  Require(density > 0.0 && density <= 1.0, "density", density, "above 0, at most 1");
  Require(leak > 0.0 && leak <= 1.0, "leak", leak, "above 0, at most 1");
  Require(shared_rows == 1 || shared_rows == 4,
          "shared_rows: " + std::to_string(shared_rows) + ", expected 1 or 4");
  Require(input_limit > 0.0, "input_limit", input_limit, "a number above 0");
}

Eigen::MatrixXd EllMatrix::Dense() const {
  Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(rows, rows);
  for (int row = 0; row < rows; ++row) {
    for (int j = 0; j < entries; ++j) {
      const std::size_t at = static_cast<std::size_t>(row) * static_cast<std::size_t>(entries) +
                             static_cast<std::size_t>(j);
      dense(row, column[at]) = value[at];
    }
  }
  return dense;
}

void Weights::Check() const {
  hyper.Check();
  Require(std::isfinite(period_s) && period_s > 0.0,
          "period_s: " + std::to_string(period_s) + ", expected above 0");
  const Eigen::Index n = hyper.neurons;
  const Eigen::Index m = input_weight.cols();
  const Eigen::Index o = readout.rows();
  Require(m >= 1, "input_weight: no columns, expected one for each input");
  Require(o >= 1, "readout: no rows, expected one for each output");
  Require(inputs.empty() || static_cast<Eigen::Index>(inputs.size()) == m,
          "inputs: " + std::to_string(inputs.size()) + " names, expected " + std::to_string(m));
  for (const Input& signal : inputs) {
    Require(signal.joint >= 0 && signal.joint < types::kMaxJoints,
            "inputs: joint " + std::to_string(signal.joint) + ", expected 0 .. " +
                std::to_string(types::kMaxJoints - 1));
  }
  RequireShape(input_weight, n, m, "input_weight");
  RequireShape(bias, n, 1, "bias");
  RequireShape(readout, o, 1 + m + n, "readout");
  RequireNormalisation(input, m, "input");
  RequireNormalisation(output, o, "output");

  Require(reservoir.rows == n,
          "reservoir: " + std::to_string(reservoir.rows) + " rows, expected " + std::to_string(n));
  Require(reservoir.entries >= 1 && reservoir.entries <= reservoir.rows,
          "reservoir: " + std::to_string(reservoir.entries) + " entries in a row, expected 1 .. " +
              std::to_string(reservoir.rows));
  const std::size_t size =
      static_cast<std::size_t>(reservoir.rows) * static_cast<std::size_t>(reservoir.entries);
  Require(reservoir.column.size() == size,
          "reservoir.column: " + std::to_string(reservoir.column.size()) + " numbers, expected " +
              std::to_string(size));
  Require(reservoir.value.size() == size,
          "reservoir.value: " + std::to_string(reservoir.value.size()) + " numbers, expected " +
              std::to_string(size));
  for (std::size_t i = 0; i < size; ++i) {
    Require(reservoir.column[i] >= 0 && reservoir.column[i] < reservoir.rows,
            "reservoir.column[" + std::to_string(i) + "]: " + std::to_string(reservoir.column[i]) +
                ", expected 0 .. " + std::to_string(reservoir.rows - 1));
    const bool first = i % static_cast<std::size_t>(reservoir.entries) == 0;
    Require(first || reservoir.column[i] > reservoir.column[i - 1],
            "reservoir.column[" + std::to_string(i) + "]: not above the one before it in the row");
    Require(std::isfinite(reservoir.value[i]),
            "reservoir.value[" + std::to_string(i) + "]: not finite");
  }
}

double SpectralRadius(const EllMatrix& matrix) {
  const Eigen::EigenSolver<Eigen::MatrixXd> solver(matrix.Dense(), false);
  if (solver.info() != Eigen::Success)
    throw std::invalid_argument("reservoir: eigenvalues did not converge");
  return solver.eigenvalues().cwiseAbs().maxCoeff();
}

Weights MakeWeights(const Hyperparameters& hyper, int inputs, int outputs) {
  hyper.Check();
  Require(inputs >= 1, "inputs: " + std::to_string(inputs) + ", expected at least 1");
  Require(outputs >= 1, "outputs: " + std::to_string(outputs) + ", expected at least 1");
  const int n = hyper.neurons;
  NormalGenerator random(hyper.seed);

  Weights weights;
  weights.hyper = hyper;
  EllMatrix& w = weights.reservoir;
  w.rows = n;
  w.entries = std::clamp(static_cast<int>(std::lround(hyper.density * n)), 1, n);
  const std::size_t size = static_cast<std::size_t>(n) * static_cast<std::size_t>(w.entries);
  w.column.reserve(size);
  w.value.reserve(size);
  std::vector<int> columns;
  std::vector<int> shuffled(static_cast<std::size_t>(n));
  std::iota(shuffled.begin(), shuffled.end(), 0);
  for (int row = 0; row < n; ++row) {
    if (row % hyper.shared_rows == 0) {
      for (int j = 0; j < w.entries; ++j) {
        std::swap(shuffled[static_cast<std::size_t>(j)],
                  shuffled[static_cast<std::size_t>(j + random.Below(n - j))]);
      }
      columns.assign(shuffled.begin(), shuffled.begin() + w.entries);
      std::sort(columns.begin(), columns.end());
    }
    w.column.insert(w.column.end(), columns.begin(), columns.end());
    for (int j = 0; j < w.entries; ++j) w.value.push_back(random.Next());
  }
  const double radius = SpectralRadius(w);
  Require(
      radius > 1e-9,
      "reservoir: all eigenvalues are zero; take more neurons, a higher density or another seed");
  for (double& value : w.value) value *= hyper.spectral_radius / radius;

  weights.input_weight.resize(n, inputs);
  const double deviation = std::sqrt(hyper.input_variance);
  for (int row = 0; row < n; ++row) {
    for (int m = 0; m < inputs; ++m) weights.input_weight(row, m) = deviation * random.Next();
  }
  weights.bias.resize(n);
  for (int row = 0; row < n; ++row) weights.bias(row) = random.Next();
  weights.input = {Eigen::VectorXd::Zero(inputs), Eigen::VectorXd::Ones(inputs)};
  weights.output = {Eigen::VectorXd::Zero(outputs), Eigen::VectorXd::Ones(outputs)};
  weights.readout = Eigen::MatrixXd::Zero(outputs, weights.feature_count());
  return weights;
}

}  // namespace sinew::esn
