// Friction that builds up over an angle after each reversal, where the declared model has a step:
// the Dahl model put beside sign v, as what is missing from a step.
//
//     dz/dt = v / xs * (1 - z sign v),   tau = -F (z - sign v)
//
// With F equal to the Coulomb friction the step is replaced by the Dahl curve.
#include "components/model/effects/dahl.h"

namespace sinew::effects::presliding {

namespace {

class Presliding final : public Dahl {
 public:
  Presliding() {
    info_.name = "presliding";
    info_.title = "Friction that builds up after a reversal";
    info_.formula = "- F * (z - sign v), dz/dt = v / xs * (1 - z sign v)";
    info_.source = "Dahl: A Solid Friction Model (1968)";
    info_.linear = {{.name = "friction",
                     .dimension = Dimension::kTorque,
                     .lower = 0.0,
                     .upper = 1e3,
                     .default_value = 0.0,
                     .meaning = "friction that is not there at once after a reversal"}};
    info_.nonlinear = {{.name = "displacement",
                        .dimension = Dimension::kAngle,
                        .lower = 1e-9,
                        .upper = 3.0,
                        .default_value = 0.02,
                        .grid = {0.005, 0.01, 0.02, 0.04, 0.08},
                        .meaning = "xs, the stroke over which it builds up"}};
    info_.smallest = Smallest::kCounts;
    info_.signature = "less friction than declared after each reversal, growing with the stroke";
    info_.variable = "position_rad";
    info_.confounders = {"seal_hysteresis", "stribeck", "coulomb"};
    info_.separating_excitation =
        "small strokes at one pressure, then at another; a seal's hysteresis grows with pressure";
    info_.needs = {"position_rad", "velocity_rad_s"};
  }

  void Regressors(const JointSample& x, std::span<const double> /*psi*/,
                  std::span<const double> memory, std::span<double> phi) const noexcept override {
    phi[0] = Sign(x.velocity_rad_s) - memory[0];
  }
};

}  // namespace

std::unique_ptr<Effect> Make(const JointConstants& /*constants*/) {
  return std::make_unique<Presliding>();
}

}  // namespace sinew::effects::presliding
