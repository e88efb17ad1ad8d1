#include "components/robot/provider/participant/provider_options.h"

#include <CLI/CLI.hpp>
#include <chrono>
#include <memory>
#include <string>

#include "components/robot/provider/participant/fall_section.h"
#include "components/topics/node/time_option.h"

namespace sinew::provider {

void AddProviderOptions(CLI::App& app, ProviderOptions* options) {
  app.add_option("--rate", options->rate_Hz, "Cycles per second")
      ->check(CLI::Range(1.0, 2000.0))
      ->capture_default_str();
  app.add_option("--duration", options->duration_s,
                 "Length of the session in seconds; 0: until stopped")
      ->check(node::IsTime(node::Zero::kAllowed));
  app.add_flag("--arm", options->arm, "Armed from the first tick (simulation only)");
  app.add_option(
         "--await", options->await,
         "Lockstep: topics whose answer ends a tick, comma-separated; TOPIC:WINDOW lets it lag")
      ->delimiter(',');
  app.add_option("--await-timeout", options->await_timeout_s,
                 "Seconds after which a missing answer is an error")
      ->check(node::IsTime(node::Zero::kRefused))
      ->capture_default_str();
}

GuardConfig LoadGuardConfig(const config::Section& guard) {
  GuardConfig config;
  config.missed_periods = static_cast<int>(guard.IntegerOr("missed_periods", 3, {1, 100}));
  config.fault_after = std::chrono::milliseconds(guard.IntegerOr("fault_after_ms", 60, {1, 10000}));
  config.bridging = guard.ChoiceOr("bridging", "damp", {"damp", "hold"}) == "hold"
                        ? Bridging::kHold
                        : Bridging::kDamp;
  const std::string others =
      guard.ChoiceOr("on_joint_fault", "idle", {"idle", "damp", "hold", "continue"});
  config.on_joint_fault = others == "continue" ? OtherJointsPolicy::kContinue
                          : others == "hold"   ? OtherJointsPolicy::kHold
                          : others == "damp"   ? OtherJointsPolicy::kDamp
                                               : OtherJointsPolicy::kIdle;
  config.valves_in_fault = guard.ChoiceOr("valves_in_fault", "hold", {"hold", "vent"}) == "vent"
                               ? ValvesInFault::kVent
                               : ValvesInFault::kHold;
  config.damping_Nm_s_rad =
      guard.NumberOr("damping_Nm_s_rad", config.damping_Nm_s_rad, config::kNotNegative);
  if (guard.Has("fall")) {
    const config::Section fall = guard.Child("fall");
    config.on_fall = fall.ChoiceOr("on_fall", "idle", {"idle", "damp"}) == "damp"
                         ? FallPolicy::kDamp
                         : FallPolicy::kIdle;
    config.fall = std::make_shared<const FallGuardConfig>(ReadFallGuard(fall));
  }
  return config;
}

}  // namespace sinew::provider
