#include "components/learn/rls/dispatch.h"

#include <vector>

#include "components/base/simd/fastest.h"

namespace sinew::rls::internal {

const Kernel& KernelFor(simd::Instructions instructions) noexcept {
#if defined(__x86_64__)
  if (instructions == simd::Instructions::kAvx512) return kAvx512Kernel;
  if (instructions == simd::Instructions::kAvx2) return kAvx2Kernel;
#endif
  (void)instructions;
  return kPortableKernel;
}

simd::Instructions FastestUpdate() {
  static const simd::Instructions kFastest = [] {
    constexpr int kSize = 96;  // of features: a multiple of 8
    std::vector<double> u(kSize * kSize, 0.0), d(kSize, 1.0), f(kSize), gain(kSize);
    for (std::size_t j = 0; j < kSize; ++j) u[j * kSize + j] = 1.0;
    const std::vector<double> phi(kSize, 0.1);
    UpdateArguments arguments;
    arguments.size = kSize;
    arguments.stride = kSize;
    arguments.f = f.data();
    arguments.u = u.data();
    arguments.d = d.data();
    arguments.gain = gain.data();
    return simd::Fastest([&](simd::Instructions set) {
      KernelFor(set).project(u.data(), phi.data(), kSize, kSize, f.data());
      KernelFor(set).update(arguments);
    });
  }();
  return kFastest;
}

}  // namespace sinew::rls::internal
