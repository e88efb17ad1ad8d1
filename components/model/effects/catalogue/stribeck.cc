#include "components/model/effects/define.h"

namespace sinew::effects::stribeck {

std::unique_ptr<Effect> Make(EffectInfo info, const JointConstants& constants) {
  info.title = "Stribeck friction";
  info.formula = "- Fs * sign v * exp(-(v / vs)^2)";
  info.source = "Armstrong-Helouvry: Control of Machines with Friction (1991)";
  info.linear = {
      Linear("stribeck", Dimension::kTorque, {0.0, 1e3}, "breakaway above Coulomb friction")};
  info.nonlinear = {Nonlinear("stribeck_velocity", Dimension::kVelocity, {1e-4, 10.0}, 0.05,
                              {0.002, 0.004, 0.008, 0.015, 0.03, 0.06, 0.12, 0.25},
                              "speed at which it has fallen to 1/e")};
  info.signature = "extra friction below vs, falling with speed";
  info.confounders = {"coulomb", "viscous", "seal_hysteresis"};
  info.separating_excitation = "slow ramps and constant speeds below and above vs, both directions";
  info.needs = {"velocity_rad_s"};
  return Memoryless(constants, std::move(info),
                    [](const JointSample& x, const JointConstants&, std::span<const double> psi) {
                      const double s = x.velocity_rad_s / psi[0];
                      return -Sign(x.velocity_rad_s) * std::exp(-s * s);
                    });
}

}  // namespace sinew::effects::stribeck
