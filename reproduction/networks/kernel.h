// The inner loops of the networks, each compiled for several instruction sets
// (components/base/simd), in float and in double. Plain pointers on purpose: the kernel files
// include nothing that could leak wide instructions elsewhere.
//
// A tile is a few samples side by side: row r of a tile holds one quantity of all its samples,
// `lanes` numbers, lanes a multiple of kLaneBytes / sizeof(S). No operation is fused and sums have
// a fixed order, so every instruction set gives the same bits.
#pragma once

namespace sinew::networks::internal {

inline constexpr int kLaneBytes = 64;  // 16 floats or 8 doubles

template <typename S>
inline constexpr int kLanesOf = kLaneBytes / static_cast<int>(sizeof(S));

template <typename S>
struct Kernel {
  // y[o][.] = sum_i w[o * in + i] x[i][.], added to y when `add`.
  void (*affine)(const S* w, const S* x, S* y, int out, int in, int lanes, bool add) noexcept;
  // sum[o][i][.] += sum over steps and packs of dy[o] x[i]; sum: out x in x kLanesOf. A step's
  // tiles lie dy_stride and x_stride numbers behind the one before.
  void (*outer)(const S* dy, const S* x, S* sum, int out, int in, int lanes, int steps,
                int dy_stride, int x_stride) noexcept;
  // total[k] = sum of the kLanesOf numbers sum[k][.], pairwise.
  void (*reduce)(const S* sum, S* total, int count) noexcept;

  // In place; count a multiple of kLanesOf.
  void (*tanh)(S* values, int count) noexcept;
  void (*relu)(S* values, int count) noexcept;
  // dy *= 1 - y^2, and dy = 0 where y <= 0.
  void (*tanh_back)(const S* y, S* dy, int count) noexcept;
  void (*relu_back)(const S* y, S* dy, int count) noexcept;

  // (4.28)-(4.32). gates: i, f, g, o before their functions, n numbers each; after: their values.
  // c: c(t-1) -> c_next: c(t); tanh_c: tanh c(t); h: h(t).
  void (*lstm)(S* gates, const S* c, S* c_next, S* tanh_c, S* h, int n) noexcept;
  // gates: values -> derivatives before the functions. dc: of c(t) without what comes through h(t)
  // -> of c(t-1).
  void (*lstm_back)(S* gates, const S* c, const S* tanh_c, const S* dh, S* dc, int n) noexcept;

  // (4.33)-(4.36), the reset gate behind the product with U (two biases):
  //     r, z = sigmoid(from_x + from_h), m = tanh(from_x + r from_h), h = (1 - z) h_before + z m
  // from_x: r, z, m parts -> their values. from_h: r, z, m parts, kept.
  void (*gru)(S* from_x, const S* from_h, const S* h_before, S* h, int n) noexcept;
  // values: r, z, m -> derivatives of the from_x parts. from_h: -> derivatives of the from_h parts.
  // dh: of h(t) -> of h(t-1) without what goes through from_h.
  void (*gru_back)(S* values, S* from_h, const S* h_before, S* dh, int n) noexcept;

  // One sample: y[.] = sum_i x[i] columns[i][.]; rows a multiple of kLanesOf.
  void (*columns)(const S* columns, const S* x, S* y, int rows, int in) noexcept;
};

extern const Kernel<float> kPortableFloat, kAvx2Float, kAvx512Float;
extern const Kernel<double> kPortableDouble, kAvx2Double, kAvx512Double;

}  // namespace sinew::networks::internal
