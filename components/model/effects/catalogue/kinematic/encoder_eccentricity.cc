// Encoder whose magnet or disc is off its axis: an error that repeats with the turn it sits on.
#include <algorithm>

#include "components/model/effects/define.h"

namespace sinew::effects::kinematic::encoder_eccentricity {

std::unique_ptr<Effect> Make(EffectInfo info, const JointConstants& constants) {
  info.title = "Eccentric encoder";
  info.formula = "+ A * sin(n q) + B * cos(n q), q = motor angle / N";
  info.rotary_only = true;
  info.source =
      "Kavanagh: Errors in quadrature encoders, IEEE Trans. Instrum. Meas. 49 (2000) "
      "1346; one period per turn from an offset, two from a tilt";
  info.linear = {Linear("sine", Dimension::kAngle, {-0.2, 0.2},
                        "error of the output's reading that goes with the sine"),
                 Linear("cosine", Dimension::kAngle, {-0.2, 0.2},
                        "error of the output's reading that goes with the cosine")};
  // Periods per turn of the output: 1 and 2 of its own encoder, N and 2 N of the motor's.
  std::vector<double> orders = {1.0, 2.0};
  if (constants.gear_ratio > 4.0) {
    orders.push_back(constants.gear_ratio);
    orders.push_back(2.0 * constants.gear_ratio);
  }
  info.nonlinear = {Nonlinear("order", Dimension::kNone,
                              {0.5, std::max(12.0, 8.0 * constants.gear_ratio)}, 1.0, orders,
                              "periods per output turn")};
  info.signature = "difference of the encoders periodic in the angle, on both sides of the play";
  info.confounders = {"gear_compliance"};
  info.separating_excitation = "the same angles under opposite load";
  info.needs = {"motor_position_rad"};
  // The motor's angle is the finer one and is right for either encoder: inside the play the two
  // differ by less than a fortieth of a radian of the output.
  return Memoryless(constants, std::move(info),
                    [](const JointSample& x, const JointConstants& c, std::span<const double> psi,
                       std::span<double> phi) {
                      const double angle = psi[0] * x.motor_position_rad / c.gear_ratio;
                      phi[0] = std::sin(angle);
                      phi[1] = std::cos(angle);
                    });
}

}  // namespace sinew::effects::kinematic::encoder_eccentricity
