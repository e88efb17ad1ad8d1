// An undeclared payload put on (or taken off) during a run. The instant is no property of the
// robot: tracing looks for the instant in every recording and sets its clock by it
// (trace/events.h).
#include "components/model/effects/define.h"

namespace sinew::effects::payload_step {

std::unique_ptr<Effect> Make(EffectInfo info, const JointConstants& constants) {
  info.title = "Payload put on during the run";
  info.formula = "- m * (l^2 * a + g * l * cos q) from start on";
  info.rotary_only = true;
  info.event = true;
  info.source =
      "Newton; change point by generalised likelihood ratio: Basseville, Nikiforov, "
      "Detection of Abrupt Changes (1993), section 2.4";
  info.linear = {Linear("payload", Dimension::kMass, {-20.0, 20.0},
                        "mass at the load cell from then on; negative: taken off")};
  info.nonlinear = {Nonlinear("start", Dimension::kTime, {0.0, 1e6}, 0.0, {0.0},
                              "when, on the clock of the recording")};
  info.signature = "gravity and inertia that are there after an instant and not before";
  info.confounders = {"payload", "temperature_friction", "external_bump"};
  info.separating_excitation = "the same motion before and after, over the whole angle range";
  info.needs = {"time_s", "acceleration_rad_s2", "position_rad"};
  return Memoryless(
      constants, std::move(info),
      [](const JointSample& x, const JointConstants& c, std::span<const double> psi) {
        const double on = static_cast<double>(x.time_s >= psi[0]) + 0.0 * x.time_s;
        const double l = c.link_length_m;
        return -on * l * (l * x.acceleration_rad_s2 + c.gravity_m_s2 * std::cos(x.position_rad));
      });
}

}  // namespace sinew::effects::payload_step
