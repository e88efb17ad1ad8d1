// The loops of kernel.h, written once; kernel_*.cc include this file and are compiled for one
// instruction set each.
#include <cstdint>

#include "reproduction/networks/kernel.h"

namespace {

using sinew::networks::internal::Kernel;
using sinew::networks::internal::kLaneBytes;
using sinew::networks::internal::kLanesOf;

#if defined(__AVX512F__)
constexpr int kPackBytes = 64;
#elif defined(__AVX2__)
constexpr int kPackBytes = 32;
#else
constexpr int kPackBytes = 16;
#endif
constexpr int kPacks = kLaneBytes / kPackBytes;

#define SINEW_INLINE inline __attribute__((always_inline))

// A pack is a register's worth of numbers, with its bits as integers of the same width.
typedef float FloatPack __attribute__((vector_size(kPackBytes)));
typedef std::int32_t FloatBits __attribute__((vector_size(kPackBytes)));
typedef double DoublePack __attribute__((vector_size(kPackBytes)));
typedef std::int64_t DoubleBits __attribute__((vector_size(kPackBytes)));
typedef float UnalignedFloatPack __attribute__((vector_size(kPackBytes), aligned(4)));
typedef double UnalignedDoublePack __attribute__((vector_size(kPackBytes), aligned(8)));

template <typename S>
struct Types;
template <>
struct Types<float> {
  using Pack = FloatPack;
  using Bits = FloatBits;
  using Unaligned = UnalignedFloatPack;
  static constexpr std::int32_t kMagnitude = INT32_MAX, kSign = INT32_MIN;
};
template <>
struct Types<double> {
  using Pack = DoublePack;
  using Bits = DoubleBits;
  using Unaligned = UnalignedDoublePack;
  static constexpr std::int64_t kMagnitude = INT64_MAX, kSign = INT64_MIN;
};

template <typename S>
struct Lanes {
  typename Types<S>::Pack pack[kPacks];
};

template <typename S>
constexpr int kPackLanes = kPackBytes / static_cast<int>(sizeof(S));

template <typename S>
SINEW_INLINE Lanes<S> Broadcast(S value) {
  Lanes<S> result;
  for (int p = 0; p < kPacks; ++p) result.pack[p] = value - typename Types<S>::Pack{};
  return result;
}

template <typename S>
SINEW_INLINE Lanes<S> Load(const S* from) {
  Lanes<S> result;
  for (int p = 0; p < kPacks; ++p) {
    result.pack[p] =
        *reinterpret_cast<const typename Types<S>::Unaligned*>(from + p * kPackLanes<S>);
  }
  return result;
}

template <typename S>
SINEW_INLINE void Store(S* to, const Lanes<S>& a) {
  for (int p = 0; p < kPacks; ++p) {
    *reinterpret_cast<typename Types<S>::Unaligned*>(to + p * kPackLanes<S>) = a.pack[p];
  }
}

#define SINEW_LANES_OPERATOR(op)                                              \
  template <typename S>                                                       \
  SINEW_INLINE Lanes<S> operator op(const Lanes<S>& a, const Lanes<S>& b) {   \
    Lanes<S> result;                                                          \
    for (int p = 0; p < kPacks; ++p) result.pack[p] = a.pack[p] op b.pack[p]; \
    return result;                                                            \
  }
SINEW_LANES_OPERATOR(+)
SINEW_LANES_OPERATOR(-)
SINEW_LANES_OPERATOR(*)
SINEW_LANES_OPERATOR(/)
#undef SINEW_LANES_OPERATOR

// tanh(x) = (e^y - 1) / (e^y + 1), y = 2 |x| = n ln2 + r, e^y - 1 = 2^n (e^r - 1) + (2^n - 1); a
// Taylor polynomial for |r| <= ln2 / 2 whose remainder is below the rounding.
SINEW_INLINE Lanes<float> ExpMinus1(const Lanes<float>& r) {
  const auto c = [](float value) { return Broadcast(value); };
  const Lanes<float> r2 = r * r;
  const Lanes<float> low = c(1.0F / 2) + r * c(1.0F / 6);
  const Lanes<float> middle = c(1.0F / 24) + r * c(1.0F / 120);
  const Lanes<float> high = c(1.0F / 720) + r * c(1.0F / 5040);
  return r + r2 * (low + r2 * (middle + r2 * high));
}
SINEW_INLINE Lanes<double> ExpMinus1(const Lanes<double>& r) {
  const auto c = [](double value) { return Broadcast(value); };
  const Lanes<double> r2 = r * r;
  const Lanes<double> r4 = r2 * r2;
  const Lanes<double> q23 = c(1.0 / 2) + r * c(1.0 / 6);
  const Lanes<double> q45 = c(1.0 / 24) + r * c(1.0 / 120);
  const Lanes<double> q67 = c(1.0 / 720) + r * c(1.0 / 5040);
  const Lanes<double> q89 = c(1.0 / 40320) + r * c(1.0 / 362880);
  const Lanes<double> q1011 = c(1.0 / 3628800) + r * c(1.0 / 39916800);
  const Lanes<double> q1213 = c(1.0 / 479001600) + r * c(1.0 / 6227020800.0);
  return r + r2 * ((q23 + r2 * q45) + r4 * ((q67 + r2 * q89) + r4 * (q1011 + r2 * q1213)));
}

template <typename S>
struct Constants;
template <>
struct Constants<float> {
  static constexpr float kShift = 0x1.8p23F, kLimit = 10.0F;  // 1 - tanh(10) is below half a unit
  static constexpr float kLn2High = 0x1.62e4p-1F, kLn2Low = 0x1.7f7d1cp-20F;
  static constexpr int kMantissa = 23;
  static constexpr std::int32_t kBias = 127;
};
template <>
struct Constants<double> {
  static constexpr double kShift = 0x1.8p52, kLimit = 20.0;
  static constexpr double kLn2High = 0x1.62e42fee00000p-1, kLn2Low = 0x1.a39ef35793c76p-33;
  static constexpr int kMantissa = 52;
  static constexpr std::int64_t kBias = 1023;
};

template <typename S>
SINEW_INLINE Lanes<S> Tanh(const Lanes<S>& x) {
  using T = Types<S>;
  using C = Constants<S>;
  Lanes<S> y;
  for (int p = 0; p < kPacks; ++p) {
    const typename T::Pack magnitude = reinterpret_cast<typename T::Pack>(
        reinterpret_cast<typename T::Bits>(x.pack[p]) & T::kMagnitude);
    const typename T::Pack limit = C::kLimit - typename T::Pack{};
    // Not a number stays so.
    y.pack[p] = S{2} * (magnitude > limit ? limit : magnitude);
  }
  const Lanes<S> shifted =
      y * Broadcast(static_cast<S>(0x1.71547652b82fep0)) + Broadcast(C::kShift);
  const Lanes<S> n = shifted - Broadcast(C::kShift);
  const Lanes<S> r = (y - n * Broadcast(C::kLn2High)) - n * Broadcast(C::kLn2Low);
  Lanes<S> two_n;
  for (int p = 0; p < kPacks; ++p) {
    const typename T::Bits bits = reinterpret_cast<typename T::Bits>(shifted.pack[p]);
    two_n.pack[p] =
        reinterpret_cast<typename T::Pack>((bits << C::kMantissa) + (C::kBias << C::kMantissa));
  }
  const Lanes<S> up = two_n * ExpMinus1(r) + (two_n - Broadcast(S{1}));
  const Lanes<S> value = up / (up + Broadcast(S{2}));
  Lanes<S> result;
  for (int p = 0; p < kPacks; ++p) {
    result.pack[p] = reinterpret_cast<typename T::Pack>(
        reinterpret_cast<typename T::Bits>(value.pack[p]) |
        (reinterpret_cast<typename T::Bits>(x.pack[p]) & T::kSign));
  }
  return result;
}

template <typename S>
SINEW_INLINE Lanes<S> Sigmoid(const Lanes<S>& x) {
  const Lanes<S> half = Broadcast(S(0.5));
  return half + half * Tanh(half * x);
}

// rows x columns accumulators, as many as the registers hold.
template <typename S, int kRows, int kColumns>
SINEW_INLINE void AffineBlock(const S* w, const S* x, S* y, int in, int lanes, bool add) {
  constexpr int kStep = kLanesOf<S>;
  Lanes<S> sum[kRows][kColumns];
  for (int r = 0; r < kRows; ++r) {
    for (int c = 0; c < kColumns; ++c) {
      sum[r][c] = add ? Load(y + r * lanes + c * kStep) : Broadcast(S{0});
    }
  }
  for (int i = 0; i < in; ++i) {
    Lanes<S> column[kColumns];
    for (int c = 0; c < kColumns; ++c) column[c] = Load(x + i * lanes + c * kStep);
    for (int r = 0; r < kRows; ++r) {
      const Lanes<S> weight = Broadcast(w[r * in + i]);
      for (int c = 0; c < kColumns; ++c) sum[r][c] = sum[r][c] + weight * column[c];
    }
  }
  for (int r = 0; r < kRows; ++r) {
    for (int c = 0; c < kColumns; ++c) Store(y + r * lanes + c * kStep, sum[r][c]);
  }
}

template <typename S>
void Affine(const S* w, const S* x, S* y, int out, int in, int lanes, bool add) noexcept {
  constexpr int kStep = kLanesOf<S>;
  constexpr int kRows = kPacks == 1 ? 5 : 4 / kPacks;
  constexpr int kColumns = kPacks == 1 ? 4 : kPacks == 2 ? 2 : 1;
  int l = 0;
  for (; l + kColumns * kStep <= lanes; l += kColumns * kStep) {
    int o = 0;
    for (; o + kRows <= out; o += kRows) {
      AffineBlock<S, kRows, kColumns>(w + o * in, x + l, y + o * lanes + l, in, lanes, add);
    }
    for (; o < out; ++o) {
      AffineBlock<S, 1, kColumns>(w + o * in, x + l, y + o * lanes + l, in, lanes, add);
    }
  }
  for (; l < lanes; l += kStep) {
    int o = 0;
    for (; o + kRows <= out; o += kRows) {
      AffineBlock<S, kRows, 1>(w + o * in, x + l, y + o * lanes + l, in, lanes, add);
    }
    for (; o < out; ++o) {
      AffineBlock<S, 1, 1>(w + o * in, x + l, y + o * lanes + l, in, lanes, add);
    }
  }
}

template <typename S, int kRows, int kColumns>
SINEW_INLINE void OuterBlock(const S* dy, const S* x, S* sum, int in, int lanes, int steps,
                             int dy_stride, int x_stride) {
  constexpr int kStep = kLanesOf<S>;
  Lanes<S> total[kRows][kColumns];
  for (int r = 0; r < kRows; ++r) {
    for (int c = 0; c < kColumns; ++c) total[r][c] = Load(sum + (r * in + c) * kStep);
  }
  for (int t = 0; t < steps; ++t) {
    for (int l = 0; l < lanes; l += kStep) {
      Lanes<S> right[kColumns];
      for (int c = 0; c < kColumns; ++c) right[c] = Load(x + c * lanes + l);
      for (int r = 0; r < kRows; ++r) {
        const Lanes<S> left = Load(dy + r * lanes + l);
        for (int c = 0; c < kColumns; ++c) total[r][c] = total[r][c] + left * right[c];
      }
    }
    dy += dy_stride;
    x += x_stride;
  }
  for (int r = 0; r < kRows; ++r) {
    for (int c = 0; c < kColumns; ++c) Store(sum + (r * in + c) * kStep, total[r][c]);
  }
}

template <typename S>
void Outer(const S* dy, const S* x, S* sum, int out, int in, int lanes, int steps, int dy_stride,
           int x_stride) noexcept {
  constexpr int kStep = kLanesOf<S>;
  constexpr int kRows = kPacks == 1 ? 5 : kPacks == 2 ? 2 : 1;
  constexpr int kColumns = kPacks == 1 ? 4 : 2;
  int o = 0;
  for (; o + kRows <= out; o += kRows) {
    int i = 0;
    for (; i + kColumns <= in; i += kColumns) {
      OuterBlock<S, kRows, kColumns>(dy + o * lanes, x + i * lanes, sum + (o * in + i) * kStep, in,
                                     lanes, steps, dy_stride, x_stride);
    }
    for (; i < in; ++i) {
      OuterBlock<S, kRows, 1>(dy + o * lanes, x + i * lanes, sum + (o * in + i) * kStep, in, lanes,
                              steps, dy_stride, x_stride);
    }
  }
  for (; o < out; ++o) {
    for (int i = 0; i < in; ++i) {
      OuterBlock<S, 1, 1>(dy + o * lanes, x + i * lanes, sum + (o * in + i) * kStep, in, lanes,
                          steps, dy_stride, x_stride);
    }
  }
}

template <typename S>
void Reduce(const S* sum, S* total, int count) noexcept {
  constexpr int kStep = kLanesOf<S>;
  for (int k = 0; k < count; ++k) {
    S v[kStep];
    for (int l = 0; l < kStep; ++l) v[l] = sum[k * kStep + l];
    for (int width = kStep / 2; width >= 1; width /= 2) {
      for (int l = 0; l < width; ++l) v[l] += v[l + width];
    }
    total[k] = v[0];
  }
}

template <typename S>
void TanhInPlace(S* values, int count) noexcept {
  for (int i = 0; i < count; i += kLanesOf<S>) Store(values + i, Tanh(Load(values + i)));
}

template <typename S>
void Relu(S* values, int count) noexcept {
  for (int i = 0; i < count; ++i) values[i] = values[i] < S{0} ? S{0} : values[i];
}

template <typename S>
void TanhBack(const S* y, S* dy, int count) noexcept {
  for (int i = 0; i < count; i += kLanesOf<S>) {
    const Lanes<S> v = Load(y + i);
    Store(dy + i, Load(dy + i) * (Broadcast(S{1}) - v * v));
  }
}

template <typename S>
void ReluBack(const S* y, S* dy, int count) noexcept {
  for (int i = 0; i < count; ++i) dy[i] = y[i] > S{0} ? dy[i] : S{0};
}

template <typename S>
void Lstm(S* gates, const S* c, S* c_next, S* tanh_c, S* h, int n) noexcept {
  S* const in = gates;
  S* const forget = gates + n;
  S* const candidate = gates + 2 * n;
  S* const out = gates + 3 * n;
  for (int k = 0; k < n; k += kLanesOf<S>) {
    const Lanes<S> i = Sigmoid(Load(in + k));
    const Lanes<S> f = Sigmoid(Load(forget + k));
    const Lanes<S> g = Tanh(Load(candidate + k));
    const Lanes<S> o = Sigmoid(Load(out + k));
    const Lanes<S> next = f * Load(c + k) + i * g;
    const Lanes<S> squashed = Tanh(next);
    Store(in + k, i);
    Store(forget + k, f);
    Store(candidate + k, g);
    Store(out + k, o);
    Store(c_next + k, next);
    Store(tanh_c + k, squashed);
    Store(h + k, o * squashed);
  }
}

template <typename S>
void LstmBack(S* gates, const S* c, const S* tanh_c, const S* dh, S* dc, int n) noexcept {
  S* const in = gates;
  S* const forget = gates + n;
  S* const candidate = gates + 2 * n;
  S* const out = gates + 3 * n;
  const Lanes<S> one = Broadcast(S{1});
  for (int k = 0; k < n; k += kLanesOf<S>) {
    const Lanes<S> i = Load(in + k);
    const Lanes<S> f = Load(forget + k);
    const Lanes<S> g = Load(candidate + k);
    const Lanes<S> o = Load(out + k);
    const Lanes<S> squashed = Load(tanh_c + k);
    const Lanes<S> down = Load(dh + k);
    const Lanes<S> cell = Load(dc + k) + down * o * (one - squashed * squashed);
    Store(in + k, cell * g * i * (one - i));
    Store(forget + k, cell * Load(c + k) * f * (one - f));
    Store(candidate + k, cell * i * (one - g * g));
    Store(out + k, down * squashed * o * (one - o));
    Store(dc + k, cell * f);
  }
}

template <typename S>
void Gru(S* from_x, const S* from_h, const S* h_before, S* h, int n) noexcept {
  const Lanes<S> one = Broadcast(S{1});
  for (int k = 0; k < n; k += kLanesOf<S>) {
    const Lanes<S> r = Sigmoid(Load(from_x + k) + Load(from_h + k));
    const Lanes<S> z = Sigmoid(Load(from_x + n + k) + Load(from_h + n + k));
    const Lanes<S> m = Tanh(Load(from_x + 2 * n + k) + r * Load(from_h + 2 * n + k));
    Store(from_x + k, r);
    Store(from_x + n + k, z);
    Store(from_x + 2 * n + k, m);
    Store(h + k, (one - z) * Load(h_before + k) + z * m);
  }
}

template <typename S>
void GruBack(S* values, S* from_h, const S* h_before, S* dh, int n) noexcept {
  const Lanes<S> one = Broadcast(S{1});
  for (int k = 0; k < n; k += kLanesOf<S>) {
    const Lanes<S> r = Load(values + k);
    const Lanes<S> z = Load(values + n + k);
    const Lanes<S> m = Load(values + 2 * n + k);
    const Lanes<S> down = Load(dh + k);
    const Lanes<S> dm = down * z * (one - m * m);
    const Lanes<S> dz = down * (m - Load(h_before + k)) * z * (one - z);
    const Lanes<S> dr = dm * Load(from_h + 2 * n + k) * r * (one - r);
    Store(values + k, dr);
    Store(values + n + k, dz);
    Store(values + 2 * n + k, dm);
    Store(from_h + k, dr);
    Store(from_h + n + k, dz);
    Store(from_h + 2 * n + k, dm * r);
    Store(dh + k, down * (one - z));
  }
}

template <typename S, int kColumns>
SINEW_INLINE void ColumnsBlock(const S* columns, const S* x, S* y, int rows, int in) {
  constexpr int kStep = kLanesOf<S>;
  Lanes<S> sum[kColumns];
  for (int c = 0; c < kColumns; ++c) sum[c] = Broadcast(S{0});
  for (int i = 0; i < in; ++i) {
    const Lanes<S> value = Broadcast(x[i]);
    for (int c = 0; c < kColumns; ++c) {
      sum[c] = sum[c] + Load(columns + i * rows + c * kStep) * value;
    }
  }
  for (int c = 0; c < kColumns; ++c) Store(y + c * kStep, sum[c]);
}

template <typename S>
void Columns(const S* columns, const S* x, S* y, int rows, int in) noexcept {
  constexpr int kStep = kLanesOf<S>;
  constexpr int kColumns = kPacks == 4 ? 1 : 4 / kPacks;
  int r = 0;
  for (; r + kColumns * kStep <= rows; r += kColumns * kStep) {
    ColumnsBlock<S, kColumns>(columns + r, x, y + r, rows, in);
  }
  for (; r < rows; r += kStep) ColumnsBlock<S, 1>(columns + r, x, y + r, rows, in);
}

template <typename S>
constexpr Kernel<S> MakeKernel() {
  return {Affine<S>,   Outer<S>, Reduce<S>,   TanhInPlace<S>, Relu<S>,    TanhBack<S>,
          ReluBack<S>, Lstm<S>,  LstmBack<S>, Gru<S>,         GruBack<S>, Columns<S>};
}

}  // namespace
