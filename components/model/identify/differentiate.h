// Derivatives of uniformly sampled signals, without phase.
#pragma once

#include <Eigen/Core>

namespace sinew::identify {

// Two-point central difference (x[i+1] - x[i-1]) / (2 dt); one-sided at the ends. Gain at w:
// sin(w dt) / (w dt). Needs at least 3 samples.
Eigen::VectorXd CentralDifference(const Eigen::Ref<const Eigen::VectorXd>& x, double dt_s);

// Eighth-order central difference (Fornberg, Math. Comp. 51 (1988) 699, table 1): within 1 % of i w
// up to w dt = 1.3 (0.21 of the rate), where two points lose 26 %. The ends are extended by odd
// reflection. Needs at least 5 samples.
Eigen::VectorXd WideDifference(const Eigen::Ref<const Eigen::VectorXd>& x, double dt_s);

}  // namespace sinew::identify
