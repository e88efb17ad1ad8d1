#include "bench/falls/provoke.h"

namespace sinew::falls {

namespace {

// Hold and soft start of the shipped references.
constexpr double kSquatsBegin_s = 3.5;

RunConfig ConfigOf(const Scenario& scenario, const ProvokeOptions& options) {
  const std::string folder = options.root + "/robots/biped/";
  const auto control = [&] {
    switch (scenario.controller) {
      case Controller::kPosition:
        return "control_position.yaml";
      case Controller::kPid:
        return "control_pid_drive_ground.yaml";
      case Controller::kComputedTorque:
        break;
    }
    return "control_computed_torque.yaml";
  };
  const bool six = scenario.kind == Kind::kSix;
  RunConfig config =
      LoadRun({.world = folder + "world.yaml",
               .reference = folder + (six ? "reference_six.yaml" : "reference_benchmark.yaml"),
               .control = folder + control(),
               .inverse_dynamics = folder + "esn_model.yaml"});
  if (options.on_fall) config.guard.on_fall = *options.on_fall;
  if (options.damping_Nm_s_rad) config.guard.damping_Nm_s_rad = *options.damping_Nm_s_rad;
  config.world.seed = scenario.seed;
  config.schedule = scenario.schedule;
  config.duration_s = scenario.duration_s;
  config.after_s = options.after_s;
  return config;
}

}  // namespace

bool FallRun::found() const {
  return guarded.fault_s && unguarded.fell_s && *guarded.fault_s > scenario.acts_at_s &&
         *guarded.fault_s <= *unguarded.fell_s + kRequired_s;
}

double FallRun::latency_s() const {
  return guarded.fault_s.value_or(scenario.duration_s) - unguarded.fell_s.value_or(0.0);
}

bool SquatRun::alarm() const {
  return guarded.fault_s || guarded.upright_s < 0.0 || guarded.upright_s > kSquatsBegin_s;
}

std::optional<FallRun> ProvokeFall(const Scenario& scenario, const ProvokeOptions& options) {
  const RunConfig config = ConfigOf(scenario, options);
  RunConfig unguarded = Unguarded(config);
  unguarded.after_s = 0.0;
  FallRun run{.scenario = scenario, .unguarded = Run(unguarded), .guarded = {}};
  if (!run.unguarded.fell_s || *run.unguarded.fell_s <= scenario.acts_at_s) return std::nullopt;
  run.guarded = Run(config);
  return run;
}

std::optional<SquatRun> WatchSquats(const Scenario& scenario, const ProvokeOptions& options) {
  const RunConfig config = ConfigOf(scenario, options);
  SquatRun run{.scenario = scenario, .guarded = Run(config)};
  // With a fault the rest of the run says nothing of its health: nobody guards the second one.
  if (run.guarded.fell_s || (run.guarded.fault_s && Run(Unguarded(config)).fell_s)) {
    return std::nullopt;
  }
  return run;
}

}  // namespace sinew::falls
