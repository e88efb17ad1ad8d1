#include "reproduction/networks/stepper.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "reproduction/networks/dispatch.h"

namespace sinew::networks {
namespace {

constexpr int kWidth = internal::kLanesOf<float>;

int Padded(int count) { return (count + kWidth - 1) / kWidth * kWidth; }
std::size_t Count(int count) { return static_cast<std::size_t>(count); }

}  // namespace

Stepper::Stepper(const Model& model, RecurrentMode mode,
                 std::optional<simd::Instructions> instructions)
    : model_(model), mode_(mode) {
  model_.Check();
  if (model_.output.offset.size() != 1) {
    throw std::invalid_argument("stepper: " + std::to_string(model_.output.offset.size()) +
                                " outputs, expected 1");
  }
  const simd::Instructions set = instructions ? *instructions : internal::FastestSample();
  simd::RequireRuns(set);
  kernel_ = &internal::KernelFor<float>(set);
  measured_ = static_cast<int>(model_.inputs.size());
  inputs_ = measured_ + (model_.wiener() ? 1 : 0);
  now_ = Eigen::VectorXd::Zero(inputs_);
  if (model_.linear) {
    linear_window_.assign(Count(model_.linear->parameter_count()), 0.0);
  }
  if (model_.method == Method::kReservoir) {
    // A readout of [1, u, x] whose first parts are zero.
    esn::Weights weights = model_.reservoir;
    weights.readout.setZero();
    weights.readout.rightCols(weights.neurons()) = model_.readout;
    network_ = std::make_unique<esn::Network>(weights, instructions);
  }
  if (model_.method != Method::kNet) return;

  const Architecture& a = model_.net;
  const std::vector<Block> blocks = Blocks(a);
  const bool recurrent = a.kind != Kind::kDense;
  const int hidden = recurrent ? a.hidden.front() : 0;
  units_ = Padded(hidden);
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    const Block& block = blocks[b];
    const bool gates = recurrent && b + 1 < blocks.size();
    Layer layer;
    layer.in = block.in;
    layer.rows = gates ? block.out / hidden * units_ : Padded(block.out);
    layer.columns.assign(Count(layer.rows) * Count(layer.in), 0.0F);
    for (int o = 0; o < block.out; ++o) {
      const int row = gates ? o / hidden * units_ + o % hidden : o;
      for (int i = 0; i < block.in; ++i) {
        layer.columns[Count(i) * Count(layer.rows) + Count(row)] =
            model_.parameters(block.offset + o * block.in + i);
      }
    }
    layers_.push_back(std::move(layer));
  }
  window_.assign(Count(a.memory) * Count(inputs_), 0.0F);
  if (recurrent) {
    // [x, h, 1], [h, 1]; the padding of h is behind the 1 and is overwritten by it.
    x_.assign(Count(inputs_ + units_ + 1), 0.0F);
    h_.assign(Count(units_ + 1), 0.0F);
    for (std::vector<float>* v : {&c_, &c_next_, &tanh_c_}) v->assign(Count(units_), 0.0F);
    gates_.assign(Count(layers_[0].rows), 0.0F);
    from_h_.assign(Count(3 * units_), 0.0F);
  } else {
    int widest = 0;
    for (const Layer& layer : layers_) {
      value_.emplace_back(Count(layer.in), 1.0F);
      widest = std::max(widest, layer.rows);
    }
    gates_.assign(Count(widest), 0.0F);
  }
  value_.emplace_back(Count(Padded(a.outputs)), 0.0F);
}

void Stepper::Reset() noexcept {
  started_ = false;
  if (network_) network_->Reset();
  std::fill(h_.begin(), h_.end(), 0.0F);
  std::fill(c_.begin(), c_.end(), 0.0F);
}

void Stepper::Cell(const float* u) noexcept {
  const int hidden = model_.net.hidden.front();
  std::copy_n(u, inputs_, x_.data());
  if (model_.net.kind == Kind::kLstm) {
    std::copy_n(h_.data(), hidden, x_.data() + inputs_);
    x_[Count(inputs_ + hidden)] = 1.0F;
    kernel_->columns(layers_[0].columns.data(), x_.data(), gates_.data(), layers_[0].rows,
                     layers_[0].in);
    kernel_->lstm(gates_.data(), c_.data(), c_next_.data(), tanh_c_.data(), h_.data(), units_);
    c_.swap(c_next_);
    return;
  }
  x_[Count(inputs_)] = 1.0F;
  h_[Count(hidden)] = 1.0F;
  kernel_->columns(layers_[0].columns.data(), x_.data(), gates_.data(), layers_[0].rows,
                   layers_[0].in);
  kernel_->columns(layers_[1].columns.data(), h_.data(), from_h_.data(), layers_[1].rows,
                   layers_[1].in);
  kernel_->gru(gates_.data(), from_h_.data(), h_.data(), c_next_.data(), units_);
  std::copy_n(c_next_.data(), hidden, h_.data());
}

double Stepper::StepNet() noexcept {
  const Architecture& a = model_.net;
  float* const y = value_.back().data();
  if (a.kind == Kind::kDense) {
    std::copy_n(window_.data(), window_.size(), value_.front().data());
    for (std::size_t l = 0; l < layers_.size(); ++l) {
      const Layer& layer = layers_[l];
      const bool last = l + 1 == layers_.size();
      float* const to = last ? y : gates_.data();
      kernel_->columns(layer.columns.data(), value_[l].data(), to, layer.rows, layer.in);
      if (last) break;
      if (a.activation == Activation::kTanh) {
        kernel_->tanh(to, layer.rows);
      } else {
        kernel_->relu(to, layer.rows);
      }
      std::copy_n(to, a.hidden[l], value_[l + 1].data());
    }
    return static_cast<double>(y[0]);
  }
  if (mode_ == RecurrentMode::kCarry) {
    Cell(window_.data() + window_.size() - Count(inputs_));
  } else {
    std::fill(h_.begin(), h_.end(), 0.0F);
    std::fill(c_.begin(), c_.end(), 0.0F);
    for (int t = 0; t < a.memory; ++t) Cell(window_.data() + Count(t) * Count(inputs_));
  }
  h_[Count(a.hidden.front())] = 1.0F;
  kernel_->columns(layers_.back().columns.data(), h_.data(), y, layers_.back().rows,
                   layers_.back().in);
  return static_cast<double>(y[0]);
}

double Stepper::Step(const Eigen::Ref<const Eigen::VectorXd>& u) noexcept {
  if (u.size() != measured_ || !u.allFinite()) return std::numeric_limits<double>::quiet_NaN();
  for (int m = 0; m < measured_; ++m) {
    now_(m) = (u(m) - model_.input.offset(m)) / model_.input.scale(m);
  }
  double y = 0.0;
  if (model_.linear) {
    const LinearModel& linear = *model_.linear;
    const std::size_t width = linear.inputs.size();
    const std::size_t taps = Count(linear.taps);
    for (std::size_t n = taps; n-- > 0;) {
      for (std::size_t i = 0; i < width; ++i) {
        const double newest = now_(linear.inputs[i]);
        // Before the first sample: the first sample.
        linear_window_[n * width + i] =
            n == 0 || !started_ ? newest : linear_window_[(n - 1) * width + i];
      }
    }
    for (std::size_t k = 0; k < linear_window_.size(); ++k) {
      y += linear.coefficients(static_cast<Eigen::Index>(k)) * linear_window_[k];
    }
    if (model_.wiener()) now_(measured_) = y;
  }
  if (model_.method == Method::kReservoir) {
    (void)network_->Step(now_);
    y = network_->prediction()(0);
  } else if (model_.method == Method::kNet) {
    const std::size_t width = Count(inputs_);
    if (started_) std::copy(window_.begin() + inputs_, window_.end(), window_.begin());
    for (std::size_t at = started_ ? window_.size() - width : 0; at < window_.size(); at += width) {
      for (std::size_t m = 0; m < width; ++m) {
        window_[at + m] = static_cast<float>(now_(static_cast<Eigen::Index>(m)));
      }
    }
    y = StepNet();
  }
  started_ = true;
  return y * model_.output.scale(0) + model_.output.offset(0);
}

}  // namespace sinew::networks
