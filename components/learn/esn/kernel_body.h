// The loops of kernel.h, written once; kernel_*.cc include this file and are compiled for one
// instruction set each.
#include "components/base/simd/lanes.h"
#include "components/learn/esn/kernel.h"

namespace {

// tanh(x) = (e^y - 1) / (e^y + 1), y = 2|x|, with e^y - 1 computed without cancellation:
// y = n ln2 + r, e^y - 1 = 2^n (e^r - 1) + (2^n - 1), and a Taylor polynomial of degree 13 for
// |r| <= ln2 / 2 (its remainder is below 2e-17 relative). Beyond |x| = 20 the result is +-1 in
// double. Largest error against std::tanh: 5 units in the last place
// (tests/components/learn/esn/network_test.cc).
SINEW_LANES_INLINE Lanes Tanh(const Lanes& x) {
  const Lanes y = Broadcast(2.0) * Min(Broadcast(20.0), Abs(x));
  const Lanes shifted = y * Broadcast(0x1.71547652b82fep0) + Broadcast(kShift);  // log2(e)
  const Lanes n = shifted - Broadcast(kShift);
  // ln2 in two parts; the first has 32 zero bits at its end, so that n times it is exact.
  const Lanes r = (y - n * Broadcast(0x1.62e42fee00000p-1)) - n * Broadcast(0x1.a39ef35793c76p-33);
  const Lanes r2 = r * r;
  const Lanes r4 = r2 * r2;
  const Lanes q23 = Broadcast(1.0 / 2) + r * Broadcast(1.0 / 6);
  const Lanes q45 = Broadcast(1.0 / 24) + r * Broadcast(1.0 / 120);
  const Lanes q67 = Broadcast(1.0 / 720) + r * Broadcast(1.0 / 5040);
  const Lanes q89 = Broadcast(1.0 / 40320) + r * Broadcast(1.0 / 362880);
  const Lanes q1011 = Broadcast(1.0 / 3628800) + r * Broadcast(1.0 / 39916800);
  const Lanes q1213 = Broadcast(1.0 / 479001600) + r * Broadcast(1.0 / 6227020800.0);
  const Lanes low = q23 + r2 * q45;
  const Lanes middle = q67 + r2 * q89;
  const Lanes high = q1011 + r2 * q1213;
  const Lanes exp_r_minus_1 = r + r2 * (low + r4 * (middle + r4 * high));
  const Lanes two_n = PowerOfTwo(shifted);
  const Lanes exp_y_minus_1 = two_n * exp_r_minus_1 + (two_n - Broadcast(1.0));
  return WithSignOf(exp_y_minus_1 / (exp_y_minus_1 + Broadcast(2.0)), x);
}

template <bool kShared>
void Step(const sinew::esn::internal::StepArguments& a) noexcept {
  using sinew::esn::internal::kRowBlock;
  constexpr int kIndices = kShared ? kRowBlock / sinew::esn::internal::kSharedRows : kRowBlock;
  const std::int32_t* column = a.column;
  const double* value = a.value;
  for (int row = 0; row < a.rows; row += kRowBlock) {
    Lanes sum0 = Load(a.bias + row);
    Lanes sum1 = Load(a.bias + row + kLanes);
    for (int m = 0; m < a.inputs; ++m) {
      const Lanes u = Broadcast(a.input[m]);
      const double* weight = a.input_weight + m * a.rows + row;
      sum0 = sum0 + Load(weight) * u;
      sum1 = sum1 + Load(weight + kLanes) * u;
    }
    for (int j = 0; j < a.entries; ++j) {
      const std::int32_t* other = column + kIndices / 2;
      sum0 = sum0 + Load(value) * (kShared ? Spread(a.state, column) : Gather(a.state, column));
      sum1 =
          sum1 + Load(value + kLanes) * (kShared ? Spread(a.state, other) : Gather(a.state, other));
      value += kRowBlock;
      column += kIndices;
    }
    Store(a.work + row, sum0);
    Store(a.work + row + kLanes, sum1);
  }
  const Lanes leak = Broadcast(a.leak);
  const Lanes keep = Broadcast(1.0 - a.leak);
  for (int row = 0; row < a.rows; row += kLanes) {
    Store(a.state + row, keep * Load(a.state + row) + leak * Tanh(Load(a.work + row)));
  }
}

void TanhInPlace(double* values, int count) noexcept {
  for (int i = 0; i < count; i += kLanes) Store(values + i, Tanh(Load(values + i)));
}

// As many accumulators as the registers hold.
constexpr int kTileRows = kPacks == 1 ? 8 : kPacks == 2 ? 4 : 2;
constexpr int kTileLanes = kPacks == 1 ? 2 : 1;

void Gram(const double* panels, int columns, double* gram) noexcept {
  using sinew::esn::internal::kPanelColumns;
  using sinew::esn::internal::kPanelSamples;
  const int count = columns / kPanelColumns;
  for (int pi = 0; pi < count; ++pi) {
    const double* panel_i = panels + pi * kPanelSamples * kPanelColumns;
    for (int pj = pi; pj < count; ++pj) {
      const double* panel_j = panels + pj * kPanelSamples * kPanelColumns;
      for (int i = 0; i < kPanelColumns; i += kTileRows) {
        for (int j = 0; j < kPanelColumns; j += kTileLanes * kLanes) {
          Lanes sum[kTileRows][kTileLanes];
          for (int r = 0; r < kTileRows; ++r) {
            for (int l = 0; l < kTileLanes; ++l) sum[r][l] = Broadcast(0.0);
          }
          const double* xi = panel_i + i;
          const double* xj = panel_j + j;
          for (int t = 0; t < kPanelSamples; ++t) {
            Lanes b[kTileLanes];
            for (int l = 0; l < kTileLanes; ++l) b[l] = Load(xj + l * kLanes);
            for (int r = 0; r < kTileRows; ++r) {
              const Lanes left = Broadcast(xi[r]);
              for (int l = 0; l < kTileLanes; ++l) sum[r][l] = sum[r][l] + left * b[l];
            }
            xi += kPanelColumns;
            xj += kPanelColumns;
          }
          for (int r = 0; r < kTileRows; ++r) {
            double* to = gram + (pi * kPanelColumns + i + r) * static_cast<std::int64_t>(columns) +
                         pj * kPanelColumns + j;
            for (int l = 0; l < kTileLanes; ++l) {
              Store(to + l * kLanes, Load(to + l * kLanes) + sum[r][l]);
            }
          }
        }
      }
    }
  }
}

}  // namespace
