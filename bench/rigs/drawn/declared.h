// What a laboratory would declare of a rig: terms of the project's model format with nominal values
// 5 to 15 % off, and the same terms as columns of a regression (own small code).
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "bench/rigs/drawn/rig.h"
#include "bench/rigs/drawn/sensors.h"
#include "bench/rigs/drawn/undeclared.h"

namespace sinew::rigs {

struct Parameter {
  std::string key;  // of the model format, with its unit
  double truth = 0.0;
  double nominal = 0.0;
  double tolerance = 0.0;  // relative; 0: none stated
  bool fixed = false;
};

struct Term {
  std::string effect;
  std::string balance;  // "kinematic", "gas" or empty
  std::vector<Parameter> parameters;
};

// Deterministic from the rig's number.
std::vector<Term> Declare(const Rig& rig);

// Rows of a balance: response = columns * theta + rest. The response is the raw drive in units of
// force (M, S), the raw difference of the encoders (K) or the pressure while the valve is shut (Q);
// columns are made of smoothed angles.
struct Balance {
  Eigen::VectorXd response;
  Eigen::MatrixXd columns;
  Eigen::VectorXd prior_sd;  // of each column's coefficient; infinite: none
  std::vector<int> row;      // place on the grid, + kGridStride per recording
};
inline constexpr int kGridStride = 1 << 20;

// Derivatives of even rows by a Gaussian kernel of a width in rows, zero phase.
struct Smooth {
  Eigen::VectorXd value, velocity, acceleration;  // per second
};
Smooth Differentiate(const Eigen::VectorXd& values, double rate_Hz, double width_rows);

// Which rows of a recording without noise a moving model speaks of: true where the output moves,
// away from reversals, for K and where the teeth press.
std::vector<bool> Usable(const Rig& rig, const std::vector<TrueRow>& rows, Shows shows);

// One recording's rows; `usable` by grid place.
Balance MakeBalance(const Rig& rig, const std::vector<Reading>& readings,
                    const std::vector<bool>& usable, Shows shows, double width_rows, int recording);
Balance Stack(const std::vector<Balance>& parts);

}  // namespace sinew::rigs
