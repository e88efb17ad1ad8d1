// A sum of many addends whose rounding error does not grow with their number.
//
// Neumaier's variant of Kahan's summation (Neumaier, Z. Angew. Math. Mech. 54 (1974) 39): for n
// addends |error| <= eps |sum| + O(n eps^2) sum |x|, eps = 1.1e-16. The naive sum of the 10^7 ticks
// of twelve hours at 240 Hz may lose n eps = 1e-9 of sum |x|; this one 1e-16.
// Thread: one. Allocates nothing. Needs IEEE arithmetic (no -ffast-math).
#pragma once

#include <cmath>

namespace sinew::performance {

class CompensatedSum {
 public:
  void Add(double x) noexcept {
    const double sum = sum_ + x;
    lost_ += std::abs(sum_) >= std::abs(x) ? (sum_ - sum) + x : (x - sum) + sum_;
    sum_ = sum;
  }
  double value() const noexcept { return sum_ + lost_; }

 private:
  double sum_ = 0.0;
  double lost_ = 0.0;  // what the additions so far have rounded away
};

}  // namespace sinew::performance
