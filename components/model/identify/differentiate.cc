#include "components/model/identify/differentiate.h"

#include <stdexcept>

namespace sinew::identify {

Eigen::VectorXd CentralDifference(const Eigen::Ref<const Eigen::VectorXd>& x, double dt_s) {
  const Eigen::Index n = x.size();
  if (n < 3) throw std::invalid_argument("central difference needs at least 3 samples");
  Eigen::VectorXd d(n);
  d.segment(1, n - 2) = (x.tail(n - 2) - x.head(n - 2)) / (2.0 * dt_s);
  d[0] = (x[1] - x[0]) / dt_s;
  d[n - 1] = (x[n - 1] - x[n - 2]) / dt_s;
  return d;
}

Eigen::VectorXd WideDifference(const Eigen::Ref<const Eigen::VectorXd>& x, double dt_s) {
  constexpr double kWeights[] = {4.0 / 5.0, -1.0 / 5.0, 4.0 / 105.0, -1.0 / 280.0};
  constexpr Eigen::Index kReach = 4;
  const Eigen::Index n = x.size();
  if (n < kReach + 1) throw std::invalid_argument("wide difference needs at least 5 samples");
  Eigen::VectorXd padded(n + 2 * kReach);
  for (Eigen::Index i = 0; i < kReach; ++i) {
    padded[i] = 2.0 * x[0] - x[kReach - i];
    padded[kReach + n + i] = 2.0 * x[n - 1] - x[n - 2 - i];
  }
  padded.segment(kReach, n) = x;
  Eigen::VectorXd d = Eigen::VectorXd::Zero(n);
  for (Eigen::Index k = 1; k <= kReach; ++k) {
    d += kWeights[k - 1] / dt_s * (padded.segment(kReach + k, n) - padded.segment(kReach - k, n));
  }
  return d;
}

}  // namespace sinew::identify
