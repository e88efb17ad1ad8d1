#include "components/robot/provider/participant/provider_options.h"

#include <CLI/CLI.hpp>
#include <chrono>
#include <memory>

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
  app.add_flag(
      "--arm", options->arm,
      "Armed from the first tick, in real time once a controller answers (simulation only)");
  app.add_option(
         "--await", options->await,
         "Lockstep: topics whose answer ends a tick, comma-separated; TOPIC:WINDOW lets it lag")
      ->delimiter(',');
  app.add_option(
         "--await-timeout", options->await_timeout_s,
         "Seconds after which a missing answer is an error (lockstep), or --arm is given up")
      ->check(node::IsTime(node::Zero::kRefused))
      ->capture_default_str();
}

void Describe(config::Fields& f, GuardConfig& c) {
  auto fault_after_ms = c.fault_after.count();
  f("missed_periods", c.missed_periods, {1, 100}, "without their commands: bridge the gap");
  f("fault_after_ms", fault_after_ms, {1, 10000}, "older than this: latched fault");
  c.fault_after = std::chrono::milliseconds(fault_after_ms);
  f.Word("bridging", c.bridging, {{"damp", Bridging::kDamp}, {"hold", Bridging::kHold}},
         "what bridges it");
  f.Word("on_joint_fault", c.on_joint_fault,
         {{"idle", OtherJointsPolicy::kIdle},
          {"damp", OtherJointsPolicy::kDamp},
          {"hold", OtherJointsPolicy::kHold},
          {"continue", OtherJointsPolicy::kContinue}},
         "what the other joints do");
  f.Word("valves_in_fault", c.valves_in_fault,
         {{"hold", ValvesInFault::kHold}, {"vent", ValvesInFault::kVent}}, "air of the chambers");
  f("damping_Nm_s_rad", c.damping_Nm_s_rad, config::kNotNegative, "motor side, per motor rad/s");
  f.If("fall", "of a robot on two legs: a fall is a fault", [&c](config::Fields& fall) {
    FallGuardConfig guard;
    Describe(fall, guard);
    fall.Word("on_fall", c.on_fall, {{"idle", FallPolicy::kIdle}, {"damp", FallPolicy::kDamp}},
              "what the joints do");
    c.fall = std::make_shared<const FallGuardConfig>(guard);
  });
}

GuardConfig LoadGuardConfig(const config::Section& guard) {
  GuardConfig config;
  config::Fields fields(guard);
  Describe(fields, config);
  return config;
}

}  // namespace sinew::provider
