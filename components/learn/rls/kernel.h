// The inner loops of recursive least squares, each compiled for several instruction sets
// (components/base/simd).
//
// U is stored column by column, `stride` (a multiple of 8) apart: column j holds rows 0 .. j, the 1
// of its diagonal included, and zeros below.
#pragma once

namespace sinew::rls::internal {

struct UpdateArguments {
  int size = 0;
  int stride = 0;
  int first = 0;              // columns before it have f = 0 and do not change
  double noise = 1.0;         // variance; negative: information is taken away, see rls.h
  double forgetting = 1.0;    // what D is divided by
  const double* f = nullptr;  // U' phi, stride
  double* u = nullptr;
  double* d = nullptr;     // stride
  double* gain = nullptr;  // stride; out: P phi, to be divided by the returned alpha
};

struct Kernel {
  // f = U' phi; phi and f padded with zeros to stride.
  void (*project)(const double* u, const double* phi, int size, int stride, double* f) noexcept;
  // Bierman's measurement update of U and D, then D / forgetting. Returns alpha = noise + phi' P
  // phi, which has the sign of noise.
  double (*update)(const UpdateArguments& arguments) noexcept;
  // a' b; stride a multiple of 8.
  double (*dot)(const double* a, const double* b, int stride) noexcept;
  // y += scale x
  void (*add_scaled)(double scale, const double* x, int stride, double* y) noexcept;
};

extern const Kernel kPortableKernel;
extern const Kernel kAvx2Kernel;
extern const Kernel kAvx512Kernel;

}  // namespace sinew::rls::internal
