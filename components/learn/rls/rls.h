// Recursive least squares with forgetting for the readout of a network, made to run without an end.
//
//   alpha = lambda + w phi' P phi,  k = w P phi / alpha
//   e     = y - W phi,              W <- W + e k'
//   P     <- (P - k phi' P) / lambda
//
// All outputs share the covariance P. What keeps it in bounds:
//  - P = U D U' with unit upper triangular U and positive diagonal D (Bierman 1977): positive
//    definite by construction, where the plain recursion loses definiteness after some ten thousand
//    updates at rest;
//  - a leak toward the offline readout W0: after each update one pseudo-observation
//    sqrt(rho) W0[:, i] = sqrt(rho) W[:, i] of unit noise on a cycling coordinate i, with
//    rho = leak n (1 - lambda) delta. With leak = 1 it puts back the information about a coordinate
//    that forgetting takes: directions that are not excited return to the prior precision delta and
//    to W0;
//  - clipping: where the root mean square of an innovation over the outputs is beyond clip_sigmas
//    standard deviations of the recent ones, the sample gets the weight w = limit / rms(e) (Huber
//    1964), else 1. A single wrong sample moves little, and since it counts less in P too, a
//    lasting change is followed within some tens of samples.
//
// With `directional` only what the sample says anew is forgotten (Kulhavy 1987, (18)):
//
//   alpha = 1 + w phi' P phi,  inverse of P += epsilon w phi phi',
//   epsilon = lambda - (1 - lambda) / (w phi' P phi)
//
// A direction that is not excited keeps its covariance and its weights, where the recursion above
// lets P grow by 1 / lambda in each update until the leak stops it. A direction by itself is
// forgotten as above; of n directions excited in turn each is forgotten in its turns only, so that
// lambda^n does what lambda does above.
//
//   symbol  here
//   lambda  forgetting
//   delta   prior_precision; P starts as I / delta
//   W, W0   readout(), offline readout; outputs x features
//
// One thread at a time. Memory is taken in the constructor and in Covariance() only.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "components/base/simd/instructions.h"

namespace sinew::types {
class StateArchive;
}

namespace sinew::rls {

struct Config {
  double forgetting = 0.999;         // lambda in (0, 1]; 1: nothing is forgotten
  bool directional = false;          // forget in the direction of the sample only
  double prior_precision = 0.01;     // delta > 0, of weights in target unit / feature unit
  double leak = 1.0;                 // >= 0; 0: none. Without forgetting there is none either.
  double clip_sigmas = 3.0;          // >= 0; 0: no clipping
  double innovation_memory = 0.995;  // of the running innovation variance, in (0, 1)
  double initial_innovation = 0.01;  // standard deviation at the start, > 0, target unit
};

enum class [[nodiscard]] UpdateStatus{
    kOk,
    kClipped,   // updated, with a weight below 1
    kBadInput,  // of the wrong size, not finite, or beyond kLargest: nothing changed
};

// The largest feature, target, weight and innovation that is taken. States of a reservoir are
// within 1, its inputs and torques within 10^4 in their units; the products and squares of larger
// values would overflow, and what is not a number would stay in weights and covariance for good.
inline constexpr double kLargest = 1e9;

class RecursiveLeastSquares {
 public:
  using Readout =
      Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>,
                 Eigen::Unaligned, Eigen::OuterStride<>>;

  // offline_readout: outputs x features, at least 1 x 1, finite. instructions: the fastest here if
  // not given. Throws std::invalid_argument naming what is wrong.
  RecursiveLeastSquares(const Config& config, const Eigen::MatrixXd& offline_readout,
                        std::optional<simd::Instructions> instructions = {});

  // Back to the offline readout and the prior covariance.
  void Reset() noexcept;

  // Goes on from another estimator's readout; the covariance stays. False, and nothing changed: of
  // another size, not finite, or beyond kLargest.
  [[nodiscard]] bool SetReadout(const Eigen::Ref<const Eigen::MatrixXd>& readout) noexcept;

  UpdateStatus Update(const Eigen::Ref<const Eigen::VectorXd>& features,
                      const Eigen::Ref<const Eigen::VectorXd>& target) noexcept;

  Readout readout() const noexcept {
    return Readout(weight_.data(), outputs_, size_, Eigen::OuterStride<>(stride_));
  }
  // y - W phi before the last good update, not clipped.
  const Eigen::VectorXd& innovation() const noexcept { return innovation_; }
  std::uint64_t updates() const noexcept { return updates_; }
  std::uint64_t clipped() const noexcept { return clipped_; }
  // O(features^2).
  double CovarianceTrace() const noexcept;
  Eigen::MatrixXd Covariance() const;
  void Exchange(types::StateArchive& archive);  // types/state_archive.h

  int feature_count() const noexcept { return size_; }
  int output_count() const noexcept { return outputs_; }

 private:
  void LeakOneCoordinate() noexcept;

  Config config_;
  int size_;
  int outputs_;
  int stride_;
  simd::Instructions instructions_;
  double pseudo_;  // sqrt(rho)
  double innovation_variance_ = 0.0;
  int coordinate_ = 0;
  std::uint64_t updates_ = 0;
  std::uint64_t clipped_ = 0;
  std::vector<double> u_;  // stride x size
  std::vector<double> d_;
  std::vector<double> phi_;
  std::vector<double> f_;
  std::vector<double> gain_;
  std::vector<double> weight_;   // outputs x stride, row by row
  std::vector<double> offline_;  // as weight_
  Eigen::VectorXd innovation_;
  Eigen::VectorXd error_;  // that may become the innovation
};

}  // namespace sinew::rls
