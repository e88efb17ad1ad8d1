#include "components/learn/rls/rls.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "components/base/types/require.h"
#include "components/learn/rls/dispatch.h"

namespace sinew::rls {
using types::Require;

namespace {

// The running innovation variance never falls to zero, where everything would be clipped.
constexpr double kSmallestVariance = 1e-12;

// 1 / epsilon of rls.h, spread = phi' P phi > 0. Without information in it, phi changes nothing,
// and where as much comes as is forgotten nothing does: noise without bound.
double DirectionalNoise(double forgetting, double spread) noexcept {
  constexpr double kBoundless = 1e30;
  const double noise = spread / (forgetting * spread - (1.0 - forgetting));
  return std::isfinite(noise) && spread > 0.0 ? std::clamp(noise, -kBoundless, kBoundless)
                                              : kBoundless;
}

// Into rows that are `stride` apart.
void Spread(const Eigen::Ref<const Eigen::MatrixXd>& readout, int stride,
            std::vector<double>* rows) noexcept {
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  Eigen::Map<RowMajor, Eigen::Unaligned, Eigen::OuterStride<>>(
      rows->data(), readout.rows(), readout.cols(), Eigen::OuterStride<>(stride)) = readout;
}

// Also where a value is not a number.
template <class Derived>
bool Takes(const Eigen::MatrixBase<Derived>& values) noexcept {
  return (values.array().abs() <= kLargest).all();
}

}  // namespace

RecursiveLeastSquares::RecursiveLeastSquares(const Config& config,
                                             const Eigen::MatrixXd& offline_readout,
                                             std::optional<simd::Instructions> instructions)
    : config_(config),
      size_(static_cast<int>(offline_readout.cols())),
      outputs_(static_cast<int>(offline_readout.rows())),
      stride_((size_ + 7) / 8 * 8),
      instructions_(instructions ? *instructions : internal::FastestUpdate()) {
  Require(config.forgetting > 0.0 && config.forgetting <= 1.0, "forgetting", config.forgetting,
          "above 0, at most 1");
  Require(config.prior_precision > 0.0, "prior_precision", config.prior_precision,
          "a number above 0");
  Require(config.leak >= 0.0, "leak", config.leak, "a number, at least 0");
  Require(config.clip_sigmas >= 0.0, "clip_sigmas", config.clip_sigmas, "a number, at least 0");
  Require(config.innovation_memory > 0.0 && config.innovation_memory < 1.0, "innovation_memory",
          config.innovation_memory, "between 0 and 1");
  Require(config.initial_innovation > 0.0, "initial_innovation", config.initial_innovation,
          "a number above 0");
  if (size_ < 1 || outputs_ < 1 || !offline_readout.allFinite()) {
    throw std::invalid_argument("offline readout: " + std::to_string(outputs_) + " x " +
                                std::to_string(size_) +
                                ", expected at least 1 x 1 and finite values");
  }
  simd::RequireRuns(instructions_);
  pseudo_ = std::sqrt(config.leak * size_ * (1.0 - config.forgetting) * config.prior_precision);

  const std::size_t stride = static_cast<std::size_t>(stride_);
  u_.assign(stride * static_cast<std::size_t>(size_), 0.0);
  d_.assign(stride, 0.0);
  phi_.assign(stride, 0.0);
  f_.assign(stride, 0.0);
  gain_.assign(stride, 0.0);
  offline_.assign(stride * static_cast<std::size_t>(outputs_), 0.0);
  Spread(offline_readout, stride_, &offline_);
  weight_ = offline_;
  innovation_ = error_ = Eigen::VectorXd::Zero(outputs_);
  Reset();
}

void RecursiveLeastSquares::Reset() noexcept {
  std::fill(u_.begin(), u_.end(), 0.0);
  const std::size_t stride = static_cast<std::size_t>(stride_);
  for (std::size_t j = 0; j < static_cast<std::size_t>(size_); ++j) {
    u_[j * stride + j] = 1.0;
    d_[j] = 1.0 / config_.prior_precision;
  }
  std::copy(offline_.begin(), offline_.end(), weight_.begin());
  innovation_.setZero();
  innovation_variance_ = config_.initial_innovation * config_.initial_innovation;
  coordinate_ = 0;
  updates_ = 0;
  clipped_ = 0;
}

bool RecursiveLeastSquares::SetReadout(const Eigen::Ref<const Eigen::MatrixXd>& readout) noexcept {
  if (readout.rows() != outputs_ || readout.cols() != size_ || !Takes(readout)) return false;
  Spread(readout, stride_, &weight_);
  return true;
}

UpdateStatus RecursiveLeastSquares::Update(
    const Eigen::Ref<const Eigen::VectorXd>& features,
    const Eigen::Ref<const Eigen::VectorXd>& target) noexcept {
  if (features.size() != size_ || target.size() != outputs_ || !Takes(features) || !Takes(target)) {
    return UpdateStatus::kBadInput;
  }
  const internal::Kernel& kernel = internal::KernelFor(instructions_);
  std::copy(features.data(), features.data() + size_, phi_.begin());
  for (int o = 0; o < outputs_; ++o) {
    error_(o) = target(o) - kernel.dot(weight_.data() + o * stride_, phi_.data(), stride_);
  }
  if (!Takes(error_)) return UpdateStatus::kBadInput;
  innovation_ = error_;
  double mean_square = 0.0;
  for (const double error : innovation_) mean_square += error * error / outputs_;
  double root_weight = 1.0;
  if (config_.clip_sigmas > 0.0) {
    const double limit = config_.clip_sigmas * config_.clip_sigmas * innovation_variance_;
    if (mean_square > limit) {
      root_weight = std::pow(limit / mean_square, 0.25);  // w = sqrt(limit / mean_square)
      mean_square = limit;
    }
    innovation_variance_ =
        std::max(kSmallestVariance, config_.innovation_memory * innovation_variance_ +
                                        (1.0 - config_.innovation_memory) * mean_square);
  }

  if (root_weight < 1.0) {
    for (double& value : phi_) value *= root_weight;
  }
  kernel.project(u_.data(), phi_.data(), size_, stride_, f_.data());
  internal::UpdateArguments arguments;
  arguments.size = size_;
  arguments.stride = stride_;
  arguments.f = f_.data();
  arguments.u = u_.data();
  arguments.d = d_.data();
  arguments.gain = gain_.data();
  double alpha = 1.0;
  if (config_.directional) {
    double spread = 0.0;  // phi' P phi
    for (int j = 0; j < size_; ++j) {
      const auto at = static_cast<std::size_t>(j);
      spread += d_[at] * f_[at] * f_[at];
    }
    arguments.noise = DirectionalNoise(config_.forgetting, spread);
    kernel.update(arguments);
    alpha = 1.0 + spread;
  } else {
    arguments.noise = arguments.forgetting = config_.forgetting;
    alpha = kernel.update(arguments);
  }
  for (int o = 0; o < outputs_; ++o) {
    kernel.add_scaled(root_weight * innovation_(o) / alpha, gain_.data(), stride_,
                      weight_.data() + o * stride_);
  }
  if (pseudo_ > 0.0) LeakOneCoordinate();
  ++updates_;
  if (root_weight < 1.0) ++clipped_;
  return root_weight < 1.0 ? UpdateStatus::kClipped : UpdateStatus::kOk;
}

void RecursiveLeastSquares::LeakOneCoordinate() noexcept {
  const internal::Kernel& kernel = internal::KernelFor(instructions_);
  const int i = coordinate_;
  coordinate_ = (coordinate_ + 1) % size_;
  // phi = sqrt(rho) e_i, so f is row i of U.
  std::fill(f_.begin(), f_.begin() + i, 0.0);
  for (int j = i; j < size_; ++j) {
    f_[static_cast<std::size_t>(j)] =
        pseudo_ * u_[static_cast<std::size_t>(j) * static_cast<std::size_t>(stride_) +
                     static_cast<std::size_t>(i)];
  }
  internal::UpdateArguments arguments;
  arguments.size = size_;
  arguments.stride = stride_;
  arguments.first = i;
  arguments.f = f_.data();
  arguments.u = u_.data();
  arguments.d = d_.data();
  arguments.gain = gain_.data();
  const double alpha = kernel.update(arguments);
  for (int o = 0; o < outputs_; ++o) {
    double* weight = weight_.data() + o * stride_;
    const double error =
        pseudo_ * (offline_[static_cast<std::size_t>(o * stride_ + i)] - weight[i]);
    kernel.add_scaled(error / alpha, gain_.data(), stride_, weight);
  }
}

double RecursiveLeastSquares::CovarianceTrace() const noexcept {
  const internal::Kernel& kernel = internal::KernelFor(instructions_);
  double trace = 0.0;
  for (int j = 0; j < size_; ++j) {
    const double* column = u_.data() + static_cast<std::ptrdiff_t>(j) * stride_;
    trace += d_[static_cast<std::size_t>(j)] * kernel.dot(column, column, (j / 8 + 1) * 8);
  }
  return trace;
}

Eigen::MatrixXd RecursiveLeastSquares::Covariance() const {
  const Eigen::Map<const Eigen::MatrixXd, Eigen::Unaligned, Eigen::OuterStride<>> u(
      u_.data(), size_, size_, Eigen::OuterStride<>(stride_));
  const Eigen::Map<const Eigen::VectorXd> d(d_.data(), size_);
  return u * d.asDiagonal() * u.transpose();
}

}  // namespace sinew::rls
