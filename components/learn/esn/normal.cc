#include "components/learn/esn/normal.h"

#include <cmath>
#include <numbers>

namespace sinew::esn {

double NormalGenerator::Uniform() { return (static_cast<double>(bits_() >> 11) + 0.5) * 0x1p-53; }

double NormalGenerator::Next() {
  if (has_spare_) {
    has_spare_ = false;
    return spare_;
  }
  const double radius = std::sqrt(-2.0 * std::log(Uniform()));
  const double angle = 2.0 * std::numbers::pi * Uniform();
  spare_ = radius * std::sin(angle);
  has_spare_ = true;
  return radius * std::cos(angle);
}

}  // namespace sinew::esn
