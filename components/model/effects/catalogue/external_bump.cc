// A single push from outside. When it happens is found in every recording by itself
// (trace/events.h).
#include <numbers>

#include "components/model/effects/define.h"

namespace sinew::effects::external_bump {

std::unique_ptr<Effect> Make(const JointConstants& constants) {
  EffectInfo info;
  info.name = "external_bump";
  info.title = "Push from outside";
  info.formula = "+ T * (1 - cos(2 pi s)) / 2, s = (t - start) / length in 0..1";
  info.event = true;
  info.source = "half-sine shock of test standards (IEC 60068-2-27), with smooth ends";
  info.linear = {{.name = "torque",
                  .dimension = Dimension::kTorque,
                  .lower = -1e3,
                  .upper = 1e3,
                  .default_value = 0.0,
                  .meaning = "its peak"}};
  info.nonlinear = {{.name = "start",
                     .dimension = Dimension::kTime,
                     .lower = 0.0,
                     .upper = 1e6,
                     .default_value = 0.0,
                     .grid = {0.0},
                     .meaning = "when, on the clock of the recording"},
                    {.name = "length",
                     .dimension = Dimension::kTime,
                     .lower = 0.05,
                     .upper = 10.0,
                     .default_value = 0.5,
                     .grid = {0.2, 0.4, 0.8, 1.6},
                     .meaning = "from its beginning to its end"}};
  info.signature = "one short excursion of the residual; nothing before, nothing after";
  info.variable = "time_s";
  info.confounders = {"payload_step"};
  info.separating_excitation = "the same motion again: a push does not come back";
  info.needs = {"time_s"};
  return Memoryless(constants, std::move(info),
                    [](const JointSample& x, const JointConstants&, std::span<const double> psi,
                       std::span<double> phi) {
                      const double s = (x.time_s - psi[0]) / psi[1];
                      const double on = static_cast<double>(s > 0.0 && s < 1.0);
                      // 0 * s keeps a time that is not finite from being taken for "no push".
                      phi[0] = 0.0 * s +
                               (on == 0.0 ? 0.0 : 0.5 - 0.5 * std::cos(2.0 * std::numbers::pi * s));
                    });
}

}  // namespace sinew::effects::external_bump
