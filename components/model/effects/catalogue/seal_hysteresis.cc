// Hysteresis of a pressurised seal: the Dahl model, scaled by pressure.
//
//     dz/dt = v / xs * (1 - z sign v),   tau = -c P z
#include "components/model/effects/dahl.h"

namespace sinew::effects::seal_hysteresis {

namespace {

class SealHysteresis final : public Dahl {
 public:
  using Dahl::Dahl;

  void Regressors(const JointSample& x, std::span<const double> /*psi*/,
                  std::span<const double> memory, std::span<double> phi) const noexcept override {
    phi[0] = -x.pressure_bar * memory[0];
  }
};

}  // namespace

std::unique_ptr<Effect> Make(EffectInfo info, const JointConstants&) {
  info.title = "Hysteresis of the seal";
  info.formula = "- c * P * z, dz/dt = v / xs * (1 - z sign v)";
  info.source = "Dahl: A Solid Friction Model (1968); pressure scaling: Nouri et al. (2000)";
  info.linear = {Linear("hysteresis", Dimension::kTorquePerBar, {0.0, 1e3},
                        "fully turned friction per gauge pressure")};
  info.nonlinear = {Nonlinear("displacement", Dimension::kAngle, {1e-9, 3.0}, 0.03,
                              {0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2},
                              "xs, the stroke over which the seal turns over")};
  info.signature = "friction that turns over an angle after each reversal and grows with pressure";
  info.variable = "position_rad";
  info.confounders = {"pressure_dependent_friction", "stribeck", "coulomb"};
  info.separating_excitation = "small and large strokes at several pressures";
  info.needs = {"pressure_bar", "position_rad"};
  return std::make_unique<SealHysteresis>(std::move(info));
}

}  // namespace sinew::effects::seal_hysteresis
