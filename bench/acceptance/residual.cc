#include "bench/acceptance/residual.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "components/model/actuator/file/model_file.h"
#include "components/robot/control/file/control_file.h"
#include "components/robot/pneumatics/file/pneumatics_file.h"
#include "components/robot/reference/file/reference_file.h"
#include "sim/surrogate/random.h"
#include "sim/surrogate/surrogate.h"
#include "tools/tune_pid/closed_loop.h"

namespace sinew::acceptance {
namespace {

constexpr double kRate_Hz = 240.0;

const char* MotionText(ResidualMotion motion) {
  switch (motion) {
    case ResidualMotion::kSine:  // the published control test
      return "kind: sine, center_rad: 0, amplitude_rad: 0.5236, frequency_Hz: 0.4";
    case ResidualMotion::kSlowSine:
      return "kind: sine, center_rad: 0.2, amplitude_rad: 0.4, frequency_Hz: 0.15";
    case ResidualMotion::kMultisine:
      return "kind: multisine, amplitude_rad: 0.8, lowest_frequency_Hz: 0.05, "
             "highest_frequency_Hz: 1.5, period_s: 20, tilt: 1";
    case ResidualMotion::kRamps:
      return "kind: sequence, pieces: [{kind: ramps, amplitude_rad: 0.9, speed_rad_s: 0.5, "
             "acceleration_rad_s2: 4, cycles: 1000}]";
    case ResidualMotion::kTask:
      break;
  }
  // Ways between places with pauses, then faster.
  return "kind: sequence, pieces: [REPEAT]";
}

std::string ReferenceText(ResidualMotion motion) {
  std::string text = MotionText(motion);
  if (const auto at = text.find("REPEAT"); at != std::string::npos) {
    std::string pieces;
    for (int i = 0; i < 300; ++i) {
      pieces += std::string(i > 0 ? ", " : "") +
                "{kind: move, to_rad: 0.6, speed_rad_s: 0.8, acceleration_rad_s2: 4}, "
                "{kind: hold, duration_s: 0.7}, "
                "{kind: move, to_rad: -0.5, speed_rad_s: 0.6, acceleration_rad_s2: 4}, "
                "{kind: hold, duration_s: 0.5}, "
                "{kind: multisine, duration_s: 8, fade_s: 1, amplitude_rad: 0.5, "
                "lowest_frequency_Hz: 0.2, highest_frequency_Hz: 1.2, period_s: 8, seed: " +
                std::to_string(i + 1) + "}";
    }
    text.replace(at, 6, pieces);
  }
  return "schema: sinew-reference/1\nstart: armed\nstart_delay_s: 0.5\njoints:\n  - {" + text +
         ", limits: {position_lower_rad: -2.0, position_upper_rad: 2.0, velocity_rad_s: 5.0, "
         "acceleration_rad_s2: 60.0, when_exceeded: scale}}\n";
}

// `format` with one number.
std::string Named(const char* format, double value) {
  char text[60];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

residual::JointReading ToReading(const provider::PlantSensors& sensors) {
  return {.valid = sensors.valid[0],
          .position_rad = sensors.position_rad[0],
          .motor_position_rad = sensors.motor_position_rad[0],
          .drive_input = sensors.motor_current_A[0],
          .pressure_bar = sensors.chamber_pressure_bar[0],
          .load_force_N = sensors.load_force_N[0],
          .payload_kg = sensors.declared_payload_kg[0],
          .temperature_degC = sensors.motor_temperature_degC[0],
          .valve_open = sensors.valve_open[0]};
}

}  // namespace

ResidualBench LoadResidualBench(const std::filesystem::path& rig_folder) {
  ResidualBench bench;
  bench.model = actuator::LoadRobotModel(rig_folder / "surrogate_model.yaml").joints.at(0);
  bench.control = control::LoadControl(rig_folder / "control_pid_model.yaml").joints.at(0);
  bench.pneumatics = pneumatics::LoadPneumatics(rig_folder / "pneumatics.yaml").joints.at(0);
  return bench;
}

const std::vector<ResidualMotion>& ResidualMotions() {
  static const std::vector<ResidualMotion> kMotions{
      ResidualMotion::kSine, ResidualMotion::kSlowSine, ResidualMotion::kMultisine,
      ResidualMotion::kRamps, ResidualMotion::kTask};
  return kMotions;
}

std::string MotionName(ResidualMotion motion) {
  switch (motion) {
    case ResidualMotion::kSine:
      return "sine, 30 degrees at 0.4 Hz";
    case ResidualMotion::kSlowSine:
      return "sine, 23 degrees at 0.15 Hz";
    case ResidualMotion::kMultisine:
      return "multisine to 1.5 Hz";
    case ResidualMotion::kRamps:
      return "ramps at 0.5 rad/s";
    case ResidualMotion::kTask:
      break;
  }
  return "moves, pauses, multisines";
}

ResidualScore RunResidualCase(const ResidualBench& bench, const ResidualCase& at) {
  ResidualScore score;
  score.at = at;
  surrogate::RigParameters rig;
  rig.spread = at.spread;
  rig.seed = at.seed;
  rig.pneumatics.initial_pressure_bar = at.pressure_bar;
  if (at.payload_kg > 0.0 && at.change_at_s > 0.0) {
    rig.effects.push_back({"payload", at.payload_kg, at.change_at_s});
  }
  surrogate::Surrogate plant(rig);
  residual::Monitor monitor(bench.model, bench.monitor, 1.0 / kRate_Hz);

  tune::ClosedLoopConfig loop;
  loop.control = {bench.control};
  loop.reference = config::Read<reference::LoadedReference>(
                       config::Section::Parse(ReferenceText(at.motion), MotionName(at.motion),
                                              "sinew-reference/1"))
                       .config;
  loop.pneumatics = {bench.pneumatics};
  loop.pneumatics[0].target_bar = at.pressure_bar;
  loop.rate_Hz = kRate_Hz;
  loop.duration_s = at.seconds;
  bool worn = false, alarm_before = false;
  loop.each_tick = [&](double time_s, const provider::PlantSensors& sensors) {
    const bool changed = at.change_at_s > 0.0 && time_s >= at.change_at_s;
    if (changed && !worn && (at.dry_share != 1.0 || at.viscous_share != 1.0)) {
      plant.rig().Wear(at.dry_share, at.viscous_share);
      worn = true;
    }
    const residual::MonitorOutput out = monitor.Step(time_s, ToReading(sensors));
    if (!changed) {
      if (out.learnt >= 1.0) {
        score.watched_s += 1.0 / kRate_Hz;
        if (out.state == residual::State::kWatching) score.excited_s += 1.0 / kRate_Hz;
        score.highest = std::max(score.highest, out.statistic);
      }
      if (out.alarm && !alarm_before) {
        if (score.false_alarms++ == 0) score.first_false_s = time_s;
      }
      score.noise_Nm = out.noise_Nm;
      score.correlation = monitor.test().correlation();
    } else if (out.alarm && !score.reported) {
      score.reported = true;
      score.delay_s = time_s - at.change_at_s;
      score.since_error_s = out.since_s - at.change_at_s;
    }
    if (score.reported && time_s <= at.change_at_s + kInTime_s) {
      score.follows = out.follows;
      score.rival = out.rival;
      score.change = out.change;
      score.change_error = out.change_error;
    }
    alarm_before = out.alarm;
  };
  static_cast<void>(tune::RunClosedLoop(loop, plant));
  return score;
}

std::string ChangeName(const ResidualCase& at) {
  if (at.payload_kg > 0.0) return Named("payload %.2g kg", at.payload_kg);
  if (at.dry_share != 1.0) return Named("dry friction x %.2g", at.dry_share);
  if (at.viscous_share != 1.0) return Named("viscous friction x %.2g", at.viscous_share);
  return "none";
}

residual::Cause TrueCause(const ResidualCase& at) {
  if (at.payload_kg > 0.0) return residual::Cause::kPayload;
  if (at.dry_share != 1.0) return residual::Cause::kDryFriction;
  if (at.viscous_share != 1.0) return residual::Cause::kViscousFriction;
  return residual::Cause::kNothing;
}

std::vector<ResidualCase> ResidualChanges(bool quick) {
  std::vector<ResidualCase> cases;
  ResidualCase payload, dry, viscous, more_dry, more_viscous;
  payload.payload_kg = 0.5;
  dry.dry_share = 1.3;
  more_dry.dry_share = 1.5;
  viscous.viscous_share = 1.3;
  more_viscous.viscous_share = 1.5;
  const int seeds = quick ? 2 : 20;
  std::uint64_t seed = 0;
  for (const ResidualCase& kind : {payload, dry, more_dry, viscous, more_viscous}) {
    for (const ResidualMotion motion : ResidualMotions()) {
      if (quick && motion != ResidualMotion::kSine && motion != ResidualMotion::kTask) continue;
      for (int i = 0; i < seeds; ++i) {
        ResidualCase at = kind;
        at.motion = motion;
        at.seed = ++seed;
        surrogate::RandomStream random(at.seed, 77);
        at.pressure_bar = 3.0 + 2.0 * random.Uniform();
        // After the learning, which takes longer where the motion pauses.
        at.change_at_s = 47.0 + 10.0 * random.Uniform();
        at.seconds = at.change_at_s + 8.0;
        cases.push_back(at);
      }
    }
  }
  return cases;
}

std::vector<ResidualCase> ResidualHours(bool quick) {
  std::vector<ResidualCase> cases;
  std::uint64_t seed = 5000;
  for (const ResidualMotion motion : ResidualMotions()) {
    for (int i = 0; i < (quick ? 1 : 2); ++i) {
      ResidualCase at;
      at.motion = motion;
      at.seed = ++seed;
      at.pressure_bar = i == 0 ? 4.0 : 5.0;
      at.seconds = quick ? 240.0 : 3660.0;
      cases.push_back(at);
    }
  }
  return cases;
}

bool InTime(const ResidualScore& score) {
  return score.reported && score.delay_s <= kInTime_s && score.false_alarms == 0;
}

bool CauseIsRight(const ResidualScore& score) {
  const residual::Cause cause = TrueCause(score.at);
  return score.reported && (score.follows == cause || score.rival == cause);
}

}  // namespace sinew::acceptance
