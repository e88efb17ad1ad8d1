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
  using Dahl::Dahl;

  void Regressors(const JointSample& x, std::span<const double> /*psi*/,
                  std::span<const double> memory, std::span<double> phi) const noexcept override {
    phi[0] = Sign(x.velocity_rad_s) - memory[0];
  }
};

}  // namespace

std::unique_ptr<Effect> Make(EffectInfo info, const JointConstants&) {
  info.title = "Friction that builds up after a reversal";
  info.formula = "- F * (z - sign v), dz/dt = v / xs * (1 - z sign v)";
  info.source = "Dahl: A Solid Friction Model (1968)";
  info.linear = {Linear("friction", Dimension::kTorque, {0.0, 1e3},
                        "friction that is not there at once after a reversal")};
  info.nonlinear = {Nonlinear("displacement", Dimension::kAngle, {1e-9, 3.0}, 0.02,
                              {0.005, 0.01, 0.02, 0.04, 0.08},
                              "xs, the stroke over which it builds up")};
  info.smallest = Smallest::kCounts;
  info.signature = "less friction than declared after each reversal, growing with the stroke";
  info.confounders = {"seal_hysteresis", "stribeck", "coulomb"};
  info.separating_excitation =
      "small strokes at one pressure, then at another; a seal's hysteresis grows with pressure";
  info.needs = {"position_rad", "velocity_rad_s"};
  return std::make_unique<Presliding>(std::move(info));
}

}  // namespace sinew::effects::presliding
