// A single push from outside. When it happens is found in every recording by itself
// (trace/events.h).
#include <numbers>

#include "components/model/effects/define.h"

namespace sinew::effects::external_bump {

std::unique_ptr<Effect> Make(EffectInfo info, const JointConstants& constants) {
  info.title = "Push from outside";
  info.formula = "+ T * (1 - cos(2 pi s)) / 2, s = (t - start) / length in 0..1";
  info.event = true;
  info.source = "half-sine shock of test standards (IEC 60068-2-27), with smooth ends";
  info.linear = {Linear("torque", Dimension::kTorque, {-1e3, 1e3}, "its peak")};
  info.nonlinear = {Nonlinear("start", Dimension::kTime, {0.0, 1e6}, 0.0, {0.0},
                              "when, on the clock of the recording"),
                    Nonlinear("length", Dimension::kTime, {0.05, 10.0}, 0.5, {0.2, 0.4, 0.8, 1.6},
                              "from its beginning to its end")};
  info.signature = "one short excursion of the residual; nothing before, nothing after";
  info.confounders = {"payload_step"};
  info.separating_excitation = "the same motion again: a push does not come back";
  info.needs = {"time_s"};
  return Memoryless(constants, std::move(info),
                    [](const JointSample& x, const JointConstants&, std::span<const double> psi) {
                      const double s = (x.time_s - psi[0]) / psi[1];
                      const double on = static_cast<double>(s > 0.0 && s < 1.0);
                      // 0 * s keeps a time that is not finite from being taken for "no push".
                      return 0.0 * s +
                             (on == 0.0 ? 0.0 : 0.5 - 0.5 * std::cos(2.0 * std::numbers::pi * s));
                    });
}

}  // namespace sinew::effects::external_bump
