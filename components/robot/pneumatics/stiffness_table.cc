#include "components/robot/pneumatics/stiffness_table.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace sinew::pneumatics {
namespace {

// y at x on the polygon through (xs, ys); x inside [xs.front(), xs.back()].
double Interpolate(const std::vector<double>& xs, const std::vector<double>& ys,
                   double x) noexcept {
  const auto above = std::upper_bound(xs.begin() + 1, xs.end() - 1, x);
  const auto i = static_cast<std::size_t>(above - xs.begin());
  const double share = (x - xs[i - 1]) / (xs[i] - xs[i - 1]);
  return ys[i - 1] + share * (ys[i] - ys[i - 1]);
}

bool StrictlyRising(const std::vector<double>& values) {
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!std::isfinite(values[i]) || (i > 0 && !(values[i] > values[i - 1]))) return false;
  }
  return true;
}

}  // namespace

StiffnessTable::StiffnessTable(std::vector<double> pressure_bar,
                               std::vector<double> stiffness_Nm_rad)
    : pressure_bar_(std::move(pressure_bar)), stiffness_Nm_rad_(std::move(stiffness_Nm_rad)) {
  if (pressure_bar_.size() < 2 || pressure_bar_.size() != stiffness_Nm_rad_.size()) {
    throw std::invalid_argument("a stiffness table needs two or more points, as many of each");
  }
  if (!StrictlyRising(pressure_bar_) || !StrictlyRising(stiffness_Nm_rad_)) {
    throw std::invalid_argument(
        "pressure and stiffness of the table must rise from point to point");
  }
}

double StiffnessTable::Stiffness_Nm_rad(double pressure_bar) const noexcept {
  if (empty()) return 0.0;
  return Interpolate(pressure_bar_, stiffness_Nm_rad_,
                     std::clamp(pressure_bar, pressure_bar_.front(), pressure_bar_.back()));
}

std::optional<double> StiffnessTable::Pressure_bar(double stiffness_Nm_rad) const noexcept {
  if (empty() || !(stiffness_Nm_rad >= stiffness_Nm_rad_.front()) ||
      !(stiffness_Nm_rad <= stiffness_Nm_rad_.back())) {
    return std::nullopt;
  }
  return Interpolate(stiffness_Nm_rad_, pressure_bar_, stiffness_Nm_rad);
}

}  // namespace sinew::pneumatics
