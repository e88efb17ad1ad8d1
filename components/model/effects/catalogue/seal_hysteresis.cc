// Hysteresis of a pressurised seal: the Dahl model, scaled by pressure.
//
//     dz/dt = v / xs * (1 - z sign v),   tau = -c P z
#include "components/model/effects/dahl.h"

namespace sinew::effects::seal_hysteresis {

namespace {

class SealHysteresis final : public Dahl {
 public:
  SealHysteresis() {
    info_.name = "seal_hysteresis";
    info_.title = "Hysteresis of the seal";
    info_.formula = "- c * P * z, dz/dt = v / xs * (1 - z sign v)";
    info_.source = "Dahl: A Solid Friction Model (1968); pressure scaling: Nouri et al. (2000)";
    info_.linear = {{.name = "hysteresis",
                     .dimension = Dimension::kTorquePerBar,
                     .lower = 0.0,
                     .upper = 1e3,
                     .default_value = 0.0,
                     .meaning = "fully turned friction per gauge pressure"}};
    info_.nonlinear = {{.name = "displacement",
                        .dimension = Dimension::kAngle,
                        .lower = 1e-9,
                        .upper = 3.0,
                        .default_value = 0.03,
                        .grid = {0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2},
                        .meaning = "xs, the stroke over which the seal turns over"}};
    info_.signature =
        "friction that turns over an angle after each reversal and grows with pressure";
    info_.variable = "position_rad";
    info_.confounders = {"pressure_dependent_friction", "stribeck", "coulomb"};
    info_.separating_excitation = "small and large strokes at several pressures";
    info_.needs = {"pressure_bar", "position_rad"};
  }

  void Regressors(const JointSample& x, std::span<const double> /*psi*/,
                  std::span<const double> memory, std::span<double> phi) const noexcept override {
    phi[0] = -x.pressure_bar * memory[0];
  }
};

}  // namespace

std::unique_ptr<Effect> Make(const JointConstants& /*constants*/) {
  return std::make_unique<SealHysteresis>();
}

}  // namespace sinew::effects::seal_hysteresis
