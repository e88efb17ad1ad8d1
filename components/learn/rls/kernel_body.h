// The loops of kernel.h, written once; kernel_*.cc include this file and are compiled for one
// instruction set each.
#include "components/base/simd/lanes.h"
#include "components/learn/rls/kernel.h"

namespace {

void Project(const double* u, const double* phi, int size, int stride, double* f) noexcept {
  for (int j = 0; j < size; ++j) {
    const double* column = u + static_cast<std::int64_t>(j) * stride;
    Lanes sum = Broadcast(0.0);
    for (int r = 0; r <= j; r += kLanes) sum = sum + Load(column + r) * Load(phi + r);
    f[j] = Sum(sum);
  }
}

// Bierman 1977, section V.3, with b[j] = U's gain so far. Two columns at a time share the passes
// over b: since the first of a pair is even, both end in the same lane block. Rows below the
// diagonal are zero in u and b and stay so; the diagonal's 1 makes b[j] become g[j] by itself.
double Update(const sinew::rls::internal::UpdateArguments& a) noexcept {
  const int first = a.first & ~1;
  for (int r = 0; r < a.stride; r += kLanes) Store(a.gain + r, Broadcast(0.0));
  double alpha = a.noise;
  const double inverse = 1.0 / a.forgetting;
  for (int j = 0; j < first; ++j) a.d[j] *= inverse;
  for (int j = first; j < a.size; j += 2) {
    const double g0 = a.d[j] * a.f[j];
    const double before0 = alpha;
    alpha += a.f[j] * g0;
    const double minus_lambda0 = -a.f[j] / before0;
    a.d[j] *= before0 / alpha * inverse;
    double* u0 = a.u + static_cast<std::int64_t>(j) * a.stride;
    const Lanes scale0 = Broadcast(minus_lambda0);
    const Lanes gain0 = Broadcast(g0);
    if (j + 1 == a.size) {
      for (int r = 0; r <= j; r += kLanes) {
        const Lanes old0 = Load(u0 + r);
        const Lanes b = Load(a.gain + r);
        Store(u0 + r, old0 + b * scale0);
        Store(a.gain + r, b + old0 * gain0);
      }
      break;
    }
    const double g1 = a.d[j + 1] * a.f[j + 1];
    const double before1 = alpha;
    alpha += a.f[j + 1] * g1;
    const double minus_lambda1 = -a.f[j + 1] / before1;
    a.d[j + 1] *= before1 / alpha * inverse;
    double* u1 = u0 + a.stride;
    const Lanes scale1 = Broadcast(minus_lambda1);
    const Lanes gain1 = Broadcast(g1);
    for (int r = 0; r <= j; r += kLanes) {
      const Lanes old0 = Load(u0 + r);
      const Lanes old1 = Load(u1 + r);
      const Lanes b0 = Load(a.gain + r);
      const Lanes b1 = b0 + old0 * gain0;
      Store(u0 + r, old0 + b0 * scale0);
      Store(u1 + r, old1 + b1 * scale1);
      Store(a.gain + r, b1 + old1 * gain1);
    }
  }
  return alpha;
}

double Dot(const double* a, const double* b, int stride) noexcept {
  Lanes sum = Broadcast(0.0);
  for (int r = 0; r < stride; r += kLanes) sum = sum + Load(a + r) * Load(b + r);
  return Sum(sum);
}

void AddScaled(double scale, const double* x, int stride, double* y) noexcept {
  const Lanes s = Broadcast(scale);
  for (int r = 0; r < stride; r += kLanes) Store(y + r, Load(y + r) + s * Load(x + r));
}

}  // namespace
