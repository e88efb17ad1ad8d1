// Cogging of one order per motor turn. Multiples of the pole pairs (7: 7, 14, 28) may also be an
// error of the current sensors; 84 is the least common multiple of 14 poles and 12 slots.
#include "components/model/effects/define.h"

namespace sinew::effects::cogging {

std::unique_ptr<Effect> Make(EffectInfo info, const JointConstants& constants) {
  info.title = "Cogging";
  info.formula = "+ a * sin(n * motor angle) + b * cos(n * motor angle)";
  info.source = "Hendershot, Miller: Design of Brushless Permanent-Magnet Machines";
  info.side = Side::kMotor;
  info.linear = {
      Linear("sine", Dimension::kTorque, {-100.0, 100.0}, "amplitude of the sine at the output"),
      Linear("cosine", Dimension::kTorque, {-100.0, 100.0},
             "amplitude of the cosine at the output")};
  info.nonlinear = {Nonlinear("order", Dimension::kNone, {0.5, 360.0}, 84.0,
                              {1, 2, 3, 4, 6, 7, 8, 12, 14, 21, 24, 28, 36, 42, 84},
                              "periods per motor turn")};
  info.signature = "residual periodic in motor angle";
  info.ripple = Side::kMotor;
  info.confounders = {"gear_eccentricity"};
  info.separating_excitation = "slow constant speed over several motor turns, both directions";
  info.needs = {"motor_position_rad"};
  return Memoryless(constants, std::move(info),
                    [](const JointSample& x, const JointConstants&, std::span<const double> psi,
                       std::span<double> phi) {
                      const double angle = psi[0] * (x.motor_position_rad + x.motor_turn_rad);
                      phi[0] = std::sin(angle);
                      phi[1] = std::cos(angle);
                    });
}

}  // namespace sinew::effects::cogging
