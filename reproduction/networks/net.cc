#include "reproduction/networks/net.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <stdexcept>
#include <string>

#include "reproduction/networks/dispatch.h"

namespace sinew::networks {
namespace {

std::size_t Size(int a, int b = 1, int c = 1) {
  return static_cast<std::size_t>(a) * static_cast<std::size_t>(b) * static_cast<std::size_t>(c);
}

// Uniform in [0, 1), from the bits that the standard fixes.
double Uniform(std::mt19937_64& bits) { return static_cast<double>(bits() >> 11) * 0x1p-53; }

// SplitMix64 (Steele, Lea and Flood 2014).
std::uint64_t Next(std::uint64_t* state) {
  std::uint64_t z = (*state += 0x9e3779b97f4a7c15ULL);
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
  return z ^ (z >> 31);
}

template <typename S>
void FillRow(S* tile, int row, int lanes, S value) {
  std::fill_n(tile + static_cast<std::ptrdiff_t>(row) * lanes, lanes, value);
}

}  // namespace

template <typename S>
Net<S>::Net(const Architecture& architecture, std::uint64_t seed,
            std::optional<simd::Instructions> instructions)
    : architecture_(architecture), dropout_state_(seed * 0x9e3779b97f4a7c15ULL + 1) {
  architecture.Check();
  const simd::Instructions set = instructions ? *instructions : internal::FastestTraining<S>();
  simd::RequireRuns(set);
  kernel_ = &internal::KernelFor<S>(set);
  blocks_ = Blocks(architecture_);
  const int count = architecture_.ParameterCount();
  parameters_ = Vector::Zero(count);
  gradient_ = Vector::Zero(count);
  const int width = internal::kLanesOf<S>;
  sum_.assign(Size(count, width), S{0});
  lanes_ = architecture_.kind == Kind::kDense ? 4 * width : 2 * width;

  const bool recurrent = architecture_.kind != Kind::kDense;
  const int units = recurrent ? architecture_.hidden.front() : 0;
  std::mt19937_64 bits(seed);
  for (std::size_t b = 0; b < blocks_.size(); ++b) {
    const Block& block = blocks_[b];
    const bool gates = recurrent && b + 1 < blocks_.size();
    const int out = gates ? units : block.out;  // every gate is a layer of its own
    for (int o = 0; o < block.out; ++o) {
      for (int i = 0; i < block.in; ++i) {
        S& weight = parameters_(block.offset + o * block.in + i);
        if (i + 1 == block.in) {
          const bool forget = gates && architecture_.kind == Kind::kLstm && o / units == 1;
          weight = forget ? S{1} : S{0};
          continue;
        }
        int in = block.in - 1;
        if (gates && architecture_.kind == Kind::kLstm) {
          in = i < architecture_.inputs ? architecture_.inputs : units;
        }
        const double limit = std::sqrt(6.0 / (in + out));
        weight = static_cast<S>(limit * (2.0 * Uniform(bits) - 1.0));
      }
    }
  }

  // What Backward multiplies with: the weights without their bias, transposed.
  int transposed = 0;
  for (const Block& block : blocks_) {
    transposed_offset_.push_back(transposed);
    transposed += block.out * (block.in - 1);
  }
  transposed_.assign(Size(transposed), S{0});

  const int memory = architecture_.memory;
  const int outputs = architecture_.outputs;
  output_.assign(Size(outputs, lanes_), S{0});
  doutput_.assign(Size(outputs, lanes_), S{0});
  if (!recurrent) {
    for (const Block& block : blocks_) {
      value_.emplace_back(Size(block.in, lanes_), S{0});
      FillRow(value_.back().data(), block.in - 1, lanes_, S{1});
      derivative_.emplace_back(Size(block.in, lanes_), S{0});
      mask_.emplace_back(architecture_.dropout > 0.0 ? Size(block.in, lanes_) : 0, S{1});
    }
    return;
  }
  const int x_rows = blocks_[0].in;
  x_.assign(Size(memory, x_rows, lanes_), S{0});
  for (int t = 0; t < memory; ++t) {
    FillRow(x_.data() + Size(t, x_rows, lanes_), x_rows - 1, lanes_, S{1});
  }
  dh_.assign(Size(units, lanes_), S{0});
  dc_.assign(Size(units, lanes_), S{0});
  gates_.assign(Size(memory, blocks_[0].out, lanes_), S{0});
  if (architecture_.kind == Kind::kLstm) {
    cell_.assign(Size(memory + 1, units, lanes_), S{0});
    tanh_cell_.assign(Size(memory, units, lanes_), S{0});
    h_.assign(Size(units + 1, lanes_), S{0});
    FillRow(h_.data(), units, lanes_, S{1});
  } else {
    from_h_.assign(Size(memory, blocks_[1].out, lanes_), S{0});
    h_.assign(Size(memory + 1, units + 1, lanes_), S{0});
    for (int t = 0; t <= memory; ++t) {
      FillRow(h_.data() + Size(t, units + 1, lanes_), units, lanes_, S{1});
    }
  }
}

template <typename S>
void Net<S>::Check(const Data<S>& data) const {
  if (data.inputs.rows() != architecture_.inputs || data.targets.rows() != architecture_.outputs) {
    throw std::invalid_argument("network: data with " + std::to_string(data.inputs.rows()) +
                                " inputs and " + std::to_string(data.targets.rows()) +
                                " targets, expected " + std::to_string(architecture_.inputs) +
                                " and " + std::to_string(architecture_.outputs));
  }
}

template <typename S>
void Net<S>::Transpose() {
  for (std::size_t b = 0; b < blocks_.size(); ++b) {
    const Block& block = blocks_[b];
    S* to = transposed_.data() + transposed_offset_[b];
    for (int i = 0; i + 1 < block.in; ++i) {
      for (int o = 0; o < block.out; ++o) {
        to[i * block.out + o] = parameters_(block.offset + o * block.in + i);
      }
    }
  }
}

template <typename S>
void Net<S>::Gather(const Data<S>& data, std::span<const int> indices) {
  const int inputs = architecture_.inputs;
  const int memory = architecture_.memory;
  const bool dense = architecture_.kind == Kind::kDense;
  S* const to = dense ? value_.front().data() : x_.data();
  const int step_rows = dense ? inputs : blocks_[0].in;
  const S* const from = data.inputs.data();
  const int used = static_cast<int>(indices.size());
  for (int s = 0; s < memory; ++s) {
    S* const tile = to + Size(s, step_rows, lanes_);
    for (int l = 0; l < used; ++l) {
      const int sample = indices[static_cast<std::size_t>(l)];
      // Before its sequence begins, its first sample.
      const int t = std::max(sample - memory + 1 + s, data.first[static_cast<std::size_t>(sample)]);
      for (int m = 0; m < inputs; ++m) {
        tile[m * lanes_ + l] = from[static_cast<std::ptrdiff_t>(t) * inputs + m];
      }
    }
    for (int m = 0; m < inputs; ++m) {
      for (int l = used; l < lanes_; ++l) tile[m * lanes_ + l] = S{0};
    }
  }
}

template <typename S>
void Net<S>::DropOut(int layer) {
  S* const mask = mask_[static_cast<std::size_t>(layer)].data();
  S* const value = value_[static_cast<std::size_t>(layer)].data();
  const int rows = blocks_[static_cast<std::size_t>(layer)].in - 1;
  const S keep = static_cast<S>(1.0 / (1.0 - architecture_.dropout));
  const std::uint64_t below = static_cast<std::uint64_t>(architecture_.dropout * 0x1p32);
  for (int k = 0; k < rows * lanes_; ++k) {
    mask[k] = (Next(&dropout_state_) >> 32) < below ? S{0} : keep;
    value[k] *= mask[k];
  }
}

template <typename S>
void Net<S>::Forward(bool training) {
  const S* const weights = parameters_.data();
  const internal::Kernel<S>& k = *kernel_;
  if (architecture_.kind == Kind::kDense) {
    for (std::size_t b = 0; b < blocks_.size(); ++b) {
      const Block& block = blocks_[b];
      const bool last = b + 1 == blocks_.size();
      S* const to = last ? output_.data() : value_[b + 1].data();
      k.affine(weights + block.offset, value_[b].data(), to, block.out, block.in, lanes_, false);
      if (last) return;
      if (architecture_.activation == Activation::kTanh) {
        k.tanh(to, block.out * lanes_);
      } else {
        k.relu(to, block.out * lanes_);
      }
      if (training && architecture_.dropout > 0.0) DropOut(static_cast<int>(b) + 1);
    }
    return;
  }
  const int units = architecture_.hidden.front();
  const int memory = architecture_.memory;
  const std::size_t state = Size(units, lanes_);
  const Block& first = blocks_[0];
  const Block& last = blocks_.back();
  const std::size_t x_step = Size(first.in, lanes_);
  const std::size_t gate_step = Size(first.out, lanes_);
  if (architecture_.kind == Kind::kLstm) {
    for (int t = 0; t < memory; ++t) {
      const std::size_t step = static_cast<std::size_t>(t);
      S* const gates = gates_.data() + step * gate_step;
      k.affine(weights + first.offset, x_.data() + step * x_step, gates, first.out, first.in,
               lanes_, false);
      S* const h = t + 1 == memory
                       ? h_.data()
                       : x_.data() + (step + 1) * x_step + Size(architecture_.inputs, lanes_);
      k.lstm(gates, cell_.data() + step * state, cell_.data() + (step + 1) * state,
             tanh_cell_.data() + step * state, h, units * lanes_);
    }
    k.affine(weights + last.offset, h_.data(), output_.data(), last.out, last.in, lanes_, false);
    return;
  }
  const Block& second = blocks_[1];
  const std::size_t h_step = Size(units + 1, lanes_);
  for (int t = 0; t < memory; ++t) {
    const std::size_t step = static_cast<std::size_t>(t);
    S* const gates = gates_.data() + step * gate_step;
    S* const from_h = from_h_.data() + step * gate_step;
    S* const h = h_.data() + step * h_step;
    k.affine(weights + first.offset, x_.data() + step * x_step, gates, first.out, first.in, lanes_,
             false);
    k.affine(weights + second.offset, h, from_h, second.out, second.in, lanes_, false);
    k.gru(gates, from_h, h, h + h_step, units * lanes_);
  }
  k.affine(weights + last.offset, h_.data() + static_cast<std::size_t>(memory) * h_step,
           output_.data(), last.out, last.in, lanes_, false);
}

template <typename S>
void Net<S>::Backward() {
  const internal::Kernel<S>& k = *kernel_;
  const auto sum_of = [&](const Block& block) {
    return sum_.data() + Size(block.offset, internal::kLanesOf<S>);
  };
  const auto transposed_of = [&](std::size_t b) {
    return transposed_.data() + transposed_offset_[b];
  };
  if (architecture_.kind == Kind::kDense) {
    const S* dy = doutput_.data();
    for (std::size_t b = blocks_.size(); b-- > 0;) {
      const Block& block = blocks_[b];
      k.outer(dy, value_[b].data(), sum_of(block), block.out, block.in, lanes_, 1, 0, 0);
      if (b == 0) return;
      S* const dx = derivative_[b].data();
      const int rows = block.in - 1;
      k.affine(transposed_of(b), dy, dx, rows, block.out, lanes_, false);
      if (architecture_.dropout > 0.0) {
        // value = f(z) mask: back to f(z) for the derivative of f.
        S* const value = value_[b].data();
        const S* const mask = mask_[b].data();
        for (int i = 0; i < rows * lanes_; ++i) {
          dx[i] *= mask[i];
          if (mask[i] > S{0}) value[i] /= mask[i];
        }
      }
      if (architecture_.activation == Activation::kTanh) {
        k.tanh_back(value_[b].data(), dx, rows * lanes_);
      } else {
        k.relu_back(value_[b].data(), dx, rows * lanes_);
      }
      dy = dx;
    }
    return;
  }
  const int units = architecture_.hidden.front();
  const int memory = architecture_.memory;
  const std::size_t state = Size(units, lanes_);
  const std::size_t last_index = blocks_.size() - 1;
  const Block& first = blocks_[0];
  const Block& last = blocks_[last_index];
  const int x_step = first.in * lanes_;
  const int gate_step = first.out * lanes_;
  const int h_step = (units + 1) * lanes_;
  const bool lstm = architecture_.kind == Kind::kLstm;
  const S* const h_last = lstm ? h_.data() : h_.data() + Size(memory, h_step);
  k.outer(doutput_.data(), h_last, sum_of(last), last.out, last.in, lanes_, 1, 0, 0);
  k.affine(transposed_of(last_index), doutput_.data(), dh_.data(), units, last.out, lanes_, false);
  if (lstm) {
    std::fill(dc_.begin(), dc_.end(), S{0});
    // The rows of the transposed weights that belong to h.
    const S* const to_h = transposed_of(0) + Size(architecture_.inputs, first.out);
    for (int t = memory; t-- > 0;) {
      const std::size_t step = static_cast<std::size_t>(t);
      S* const gates = gates_.data() + step * static_cast<std::size_t>(gate_step);
      k.lstm_back(gates, cell_.data() + step * state, tanh_cell_.data() + step * state, dh_.data(),
                  dc_.data(), units * lanes_);
      if (t > 0) k.affine(to_h, gates, dh_.data(), units, first.out, lanes_, false);
    }
    k.outer(gates_.data(), x_.data(), sum_of(first), first.out, first.in, lanes_, memory, gate_step,
            x_step);
    return;
  }
  const Block& second = blocks_[1];
  for (int t = memory; t-- > 0;) {
    const std::size_t step = static_cast<std::size_t>(t);
    S* const gates = gates_.data() + step * static_cast<std::size_t>(gate_step);
    S* const from_h = from_h_.data() + step * static_cast<std::size_t>(gate_step);
    k.gru_back(gates, from_h, h_.data() + step * static_cast<std::size_t>(h_step), dh_.data(),
               units * lanes_);
    if (t > 0) k.affine(transposed_of(1), from_h, dh_.data(), units, second.out, lanes_, true);
  }
  k.outer(gates_.data(), x_.data(), sum_of(first), first.out, first.in, lanes_, memory, gate_step,
          x_step);
  k.outer(from_h_.data(), h_.data(), sum_of(second), second.out, second.in, lanes_, memory,
          gate_step, h_step);
}

template <typename S>
double Net<S>::LossAndGradient(const Data<S>& data, std::span<const int> indices) {
  Check(data);
  if (indices.empty()) throw std::invalid_argument("network: no samples");
  Transpose();
  std::fill(sum_.begin(), sum_.end(), S{0});
  const int outputs = architecture_.outputs;
  const double scale = 1.0 / (static_cast<double>(indices.size()) * outputs);
  const S slope = static_cast<S>(2.0 * scale);
  double loss = 0.0;
  for (std::size_t start = 0; start < indices.size(); start += static_cast<std::size_t>(lanes_)) {
    const std::span<const int> tile =
        indices.subspan(start, std::min(static_cast<std::size_t>(lanes_), indices.size() - start));
    Gather(data, tile);
    Forward(true);
    std::fill(doutput_.begin(), doutput_.end(), S{0});
    for (int o = 0; o < outputs; ++o) {
      for (std::size_t l = 0; l < tile.size(); ++l) {
        const std::size_t at = Size(o, lanes_) + l;
        const S error = output_[at] - data.targets(o, tile[l]);
        loss += static_cast<double>(error) * static_cast<double>(error);
        doutput_[at] = slope * error;
      }
    }
    Backward();
  }
  kernel_->reduce(sum_.data(), gradient_.data(), static_cast<int>(gradient_.size()));
  return loss * scale;
}

template <typename S>
void Net<S>::Predict(const Data<S>& data, std::span<const int> indices, Eigen::MatrixXd* y) {
  Check(data);
  if (y->rows() != architecture_.outputs || y->cols() != data.inputs.cols()) {
    throw std::invalid_argument("network: predictions of another shape than the targets");
  }
  for (std::size_t start = 0; start < indices.size(); start += static_cast<std::size_t>(lanes_)) {
    const std::span<const int> tile =
        indices.subspan(start, std::min(static_cast<std::size_t>(lanes_), indices.size() - start));
    Gather(data, tile);
    Forward(false);
    for (int o = 0; o < architecture_.outputs; ++o) {
      for (std::size_t l = 0; l < tile.size(); ++l) {
        (*y)(o, tile[l]) = static_cast<double>(output_[Size(o, lanes_) + l]);
      }
    }
  }
}

template <typename S>
double Net<S>::Loss(const Data<S>& data, std::span<const int> indices) {
  Eigen::MatrixXd y(architecture_.outputs, data.inputs.cols());
  Predict(data, indices, &y);
  double sum = 0.0;
  for (const int t : indices) {
    sum += (y.col(t) - data.targets.col(t).template cast<double>()).squaredNorm();
  }
  return sum / (static_cast<double>(indices.size()) * architecture_.outputs);
}

template class Net<float>;
template class Net<double>;

}  // namespace sinew::networks
