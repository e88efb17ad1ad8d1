// Delay between the recorded drive input and its torque: T > 0 when the drive acts late. Nothing
// acts before its cause: a little below zero is a record that is filtered.
#include "components/effects/define.h"

namespace sinew::effects::transport_delay {

std::unique_ptr<Effect> Make(const JointConstants& constants) {
  EffectInfo info;
  info.name = "transport_delay";
  info.title = "Drive that acts late";
  info.formula = "- T * N Kt dI/dt";
  info.source = "first order of I(t - T)";
  info.side = Side::kMotor;
  info.smallest = Smallest::kTenthOfSample;
  info.linear = {{.name = "delay",
                  .dimension = Dimension::kTime,
                  .lower = -0.01,
                  .upper = 0.1,
                  .default_value = 0.0,
                  .meaning = "the drive acts this much later than its record says",
                  .relative_to_drive = true}};
  info.signature = "residual follows the rate of the drive input";
  info.variable = "drive_rate";
  info.look_alikes = {"elastic_joint", "flexible_link", "gear_compliance"};
  info.separating_excitation =
      "fast reversals; the delay stays when the load changes, flexibility does not";
  info.needs = {"drive_rate"};
  return Memoryless(constants, std::move(info),
                    [](const JointSample& x, const JointConstants& c, std::span<const double>,
                       std::span<double> phi) { phi[0] = -IdealDriveGain(c) * x.drive_rate; });
}

}  // namespace sinew::effects::transport_delay
