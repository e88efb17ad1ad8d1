#include <algorithm>

#include "components/model/effects/define.h"

namespace sinew::effects::gear_eccentricity {

std::unique_ptr<Effect> Make(EffectInfo info, const JointConstants& constants) {
  info.title = "Eccentric gear";
  info.formula = "+ (a + c T) * sin(n q) + (b + d T) * cos(n q), T = N Kt I";
  info.rotary_only = true;
  info.source =
      "Smith: Gear Noise and Vibration; transmission error of an eccentric wheel: the ratio, and "
      "so "
      "the torque that is handed on, varies once a turn of that wheel";
  info.linear = {Linear("sine", Dimension::kTorque, {-100.0, 100.0}, "amplitude of the sine"),
                 Linear("cosine", Dimension::kTorque, {-100.0, 100.0}, "amplitude of the cosine"),
                 RelativeToDrive(Linear("load_sine", Dimension::kNone, {-1.0, 1.0},
                                        "the same, per drive torque")),
                 RelativeToDrive(Linear("load_cosine", Dimension::kNone, {-1.0, 1.0},
                                        "the same, per drive torque"))};
  // A wheel on the output once or twice a turn of it, the planets of its carrier three or four
  // times; wheels on the motor's shaft N times.
  std::vector<double> orders = {1.0, 2.0, 3.0, 4.0};
  if (constants.gear_ratio > 2.0) {
    orders.push_back(constants.gear_ratio);
    orders.push_back(2.0 * constants.gear_ratio);
  }
  info.nonlinear = {Nonlinear("order", Dimension::kNone,
                              {0.5, std::max(12.0, 2.0 * constants.gear_ratio)}, 2.0, orders,
                              "periods per output turn")};
  info.signature = "residual periodic in the angle of a wheel, often growing with the load";
  info.ripple = Side::kOutput;
  info.confounders = {"gravity", "gravity_phase", "cogging"};
  info.separating_excitation = "slow constant speed over the whole angle range, at two loads";
  info.needs = {"position_rad"};
  info.may_read = {"drive_input"};  // and the motor's angle for wheels on its shaft
  return Memoryless(constants, std::move(info),
                    [](const JointSample& x, const JointConstants& c, std::span<const double> psi,
                       std::span<double> phi) {
                      // A wheel of the motor's side is seen best by the motor's encoder.
                      const bool fast = c.gear_ratio > 2.0 && psi[0] > 0.75 * c.gear_ratio;
                      const double angle =
                          psi[0] * (fast ? x.motor_position_rad / c.gear_ratio : x.position_rad);
                      const double load = IdealDriveGain(c) * x.drive_input;
                      phi[0] = std::sin(angle);
                      phi[1] = std::cos(angle);
                      phi[2] = load * phi[0];
                      phi[3] = load * phi[1];
                    });
}

}  // namespace sinew::effects::gear_eccentricity
