#include "components/learn/esn/network.h"

#include <algorithm>

#include "components/learn/esn/dispatch.h"

namespace sinew::esn {

namespace {

// Every group of kSharedRows rows has one list of columns; the last group may be smaller.
bool GroupsShareColumns(const EllMatrix& w) {
  const auto entries = static_cast<std::ptrdiff_t>(w.entries);
  for (int row = 0; row < w.rows; ++row) {
    const auto first =
        w.column.begin() + row / internal::kSharedRows * internal::kSharedRows * entries;
    if (!std::equal(first, first + entries, w.column.begin() + row * entries)) return false;
  }
  return true;
}

}  // namespace

Network::Network(const Weights& weights, std::optional<simd::Instructions> instructions) {
  weights.Check();
  shared_ = GroupsShareColumns(weights.reservoir);
  const simd::Instructions set = instructions ? *instructions
                                 : shared_    ? internal::FastestSharedStep()
                                              : internal::FastestStep();
  simd::RequireRuns(set);
  instructions_ = set;
  neurons_ = weights.neurons();
  inputs_ = weights.input_count();
  feature_count_ = weights.feature_count();
  rows_ = internal::Padded(neurons_, internal::kRowBlock);
  entries_ = weights.reservoir.entries;
  leak_ = weights.hyper.leak;
  input_limit_ = weights.hyper.input_limit;

  // Padding rows have zero weights and bias: their state stays 0.
  const std::size_t rows = static_cast<std::size_t>(rows_);
  const std::size_t entries = static_cast<std::size_t>(entries_);
  const std::size_t group = shared_ ? internal::kSharedRows : 1;
  column_.assign(rows / group * entries, 0);
  value_.assign(rows * entries, 0.0);
  bias_.assign(rows, 0.0);
  input_weight_.assign(rows * static_cast<std::size_t>(inputs_), 0.0);
  work_.assign(rows, 0.0);
  constexpr std::size_t kBlock = internal::kRowBlock;
  for (std::size_t row = 0; row < static_cast<std::size_t>(neurons_); ++row) {
    for (std::size_t j = 0; j < entries; ++j) {
      const std::size_t block = row / kBlock * kBlock * entries + j * kBlock;  // of this entry
      column_[block / group + row % kBlock / group] = weights.reservoir.column[row * entries + j];
      value_[block + row % kBlock] = weights.reservoir.value[row * entries + j];
    }
    bias_[row] = weights.bias(static_cast<Eigen::Index>(row));
    for (std::size_t m = 0; m < static_cast<std::size_t>(inputs_); ++m) {
      input_weight_[m * rows + row] =
          weights.input_weight(static_cast<Eigen::Index>(row), static_cast<Eigen::Index>(m));
    }
  }
  offset_ = weights.input.offset;
  scale_ = weights.input.scale;
  features_.resize(1 + inputs_ + rows_);
  readout_ = weights.readout;
  prediction_.resize(readout_.rows());
  settling_.resize(neurons_);
  Reset();
}

void Network::Reset() noexcept {
  features_.setZero();
  features_(0) = 1.0;
  prediction_.setZero();
}

StepStatus Network::Step(const Eigen::Ref<const Eigen::VectorXd>& u) noexcept {
  if (u.size() != inputs_ || !u.allFinite()) {
    prediction_.setZero();
    return StepStatus::kBadInput;
  }
  for (int m = 0; m < inputs_; ++m) {
    features_(1 + m) = std::clamp((u(m) - offset_(m)) / scale_(m), -input_limit_, input_limit_);
  }
  internal::StepArguments arguments;
  arguments.rows = rows_;
  arguments.entries = entries_;
  arguments.inputs = inputs_;
  arguments.column = column_.data();
  arguments.value = value_.data();
  arguments.bias = bias_.data();
  arguments.input_weight = input_weight_.data();
  arguments.input = features_.data() + 1;
  arguments.leak = leak_;
  arguments.state = features_.data() + 1 + inputs_;
  arguments.work = work_.data();
  const internal::Kernel& kernel = internal::KernelFor(instructions_);
  (shared_ ? kernel.step_shared : kernel.step)(arguments);
  prediction_.noalias() = readout_.lazyProduct(features_.head(feature_count_));
  return StepStatus::kOk;
}

StepStatus Network::Settle(const Eigen::Ref<const Eigen::VectorXd>& u) noexcept {
  StepStatus status = StepStatus::kOk;
  for (int k = 0; k < kSettleSteps && status == StepStatus::kOk; ++k) {
    settling_ = state();
    status = Step(u);
    if ((state() - settling_).lpNorm<Eigen::Infinity>() < kSettled) break;
  }
  return status;
}

bool Network::SetReadout(const Eigen::Ref<const Eigen::MatrixXd>& readout) noexcept {
  if (readout.rows() != readout_.rows() || readout.cols() != readout_.cols() ||
      !readout.allFinite()) {
    return false;
  }
  readout_ = readout;
  return true;
}

void Network::SetState(const Eigen::Ref<const Eigen::VectorXd>& state) noexcept {
  if (state.size() == neurons_) features_.segment(1 + inputs_, neurons_) = state;
}

void Tanh(Eigen::Ref<Eigen::VectorXd> values, simd::Instructions instructions) {
  simd::RequireRuns(instructions);
  Eigen::VectorXd padded =
      Eigen::VectorXd::Zero(internal::Padded(static_cast<int>(values.size()), 8));
  padded.head(values.size()) = values;
  internal::KernelFor(instructions).tanh(padded.data(), static_cast<int>(padded.size()));
  values = padded.head(values.size());
}

}  // namespace sinew::esn
