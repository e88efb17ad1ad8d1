// Flexible link: a part of the inertia sits on a spring with a damper. With p the angle of that
// part and a the measured acceleration, the rigid balance lacks
//
//     J_s (a - p'') ,  p'' = -2 z w (p' - v) - w^2 (p - q)
//
// that is the output of an oscillator driven by the acceleration. Far below its frequency it is
// -(J_s / w^2) snap.
//
// Memory: y = p - q, its rate, and the acceleration of the sample before; between samples the
// acceleration is taken as constant and the oscillator is solved exactly.
#include "components/base/types/angle.h"
#include "components/model/effects/define.h"

namespace sinew::effects::flexible_link {

namespace {

using types::kTwoPi;

class FlexibleLink final : public Effect {
 public:
  using Effect::Effect;

  void Regressors(const JointSample& x, std::span<const double> psi, std::span<const double> memory,
                  std::span<double> phi) const noexcept override {
    const double w = kTwoPi * psi[0];
    phi[0] = x.acceleration_rad_s2 + w * w * memory[0] + 2.0 * psi[1] * w * memory[1];
  }

  int memory_size() const noexcept override { return 3; }

  void ResetMemory(const JointSample& x, std::span<const double> psi,
                   std::span<double> memory) const noexcept override {
    const double w = kTwoPi * psi[0];
    memory[0] = -x.acceleration_rad_s2 / (w * w);
    memory[1] = 0.0;
    memory[2] = x.acceleration_rad_s2;
  }

  void Advance(const JointSample& x, double dt_s, std::span<const double> psi,
               std::span<double> memory) const noexcept override {
    const double w = kTwoPi * psi[0];
    const double z = psi[1];
    const double damped = w * std::sqrt(1.0 - z * z);
    const double level = -0.5 * (memory[2] + x.acceleration_rad_s2) / (w * w);
    const double y = memory[0] - level;
    const double rate = memory[1];
    const double fade = std::exp(-z * w * dt_s);
    const double c = fade * std::cos(damped * dt_s);
    const double s = fade * std::sin(damped * dt_s) / damped;
    memory[0] = level + c * y + s * (rate + z * w * y);
    memory[1] = c * rate - s * (w * w * y + z * w * rate);
    memory[2] = x.acceleration_rad_s2;
  }
};

}  // namespace

std::unique_ptr<Effect> Make(EffectInfo info, const JointConstants&) {
  info.title = "Flexible link";
  info.formula = "+ Js * (a - p''), p'' = - 2 z w (p' - v) - w^2 (p - q)";
  info.source = "one-mass oscillator; Spong, Modeling and Control of Elastic Joint Robots (1987)";
  info.linear = {Linear("sprung_inertia", Dimension::kInertia, {0.0, 1e3},
                        "Js, the part of the inertia that sits on the spring")};
  info.nonlinear = {
      Nonlinear("frequency", Dimension::kFrequency, {0.5, 500.0}, 10.0, {3.0, 5.0, 8.0, 14.0},
                "w / 2 pi, with the joint held"),
      Nonlinear("damping_ratio", Dimension::kNone, {0.001, 0.9}, 0.05, {0.03, 0.15}, "z")};
  info.signature = "residual follows acceleration through a resonance";
  info.confounders = {"elastic_joint", "gear_compliance", "inertia"};
  info.separating_excitation = "fast reversals and pulses with two loads";
  info.needs = {"acceleration_rad_s2"};
  return std::make_unique<FlexibleLink>(std::move(info));
}

}  // namespace sinew::effects::flexible_link
