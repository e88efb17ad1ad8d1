#include "bench/acceptance/regime.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "bench/acceptance/rig_cycle.h"
#include "components/base/types/control_mode.h"
#include "components/base/types/regime.h"
#include "sim/surrogate/rig.h"

namespace sinew::acceptance {
namespace {

using regime::Contact;
using regime::DetectorConfig;
using regime::DetectorInput;
using regime::DetectorOutput;
using regime::RegimeDetector;

constexpr double kOpen_rad = 2.0 * kCount_rad;
constexpr double kSetupPressure_bar = 3.8;  // the least that regime_active.yaml asks for
constexpr double kSetupVelocity_rad_s = 0.05;

surrogate::RigParameters Parameters(double pressure_bar, double noise_rad, std::uint64_t seed) {
  surrogate::RigParameters parameters;
  parameters.pneumatics.initial_pressure_bar = pressure_bar;
  parameters.sensors.output_encoder_noise_rad = noise_rad;
  parameters.seed = seed;
  return parameters;
}

DetectorConfig Config(const surrogate::RigParameters& rig) {
  DetectorConfig config;
  config.play.backlash_rad = rig.gear.play_rad;
  config.play.output_noise_rad = rig.sensors.output_encoder_noise_rad;
  config.gear_ratio = rig.gear.ratio;
  return config;
}

DetectorInput Input(const surrogate::RigReading& reading, double motor_offset_rad = 0.0) {
  DetectorInput input;
  input.session_id = 1;
  input.period_s = kCycle_s;
  input.armed = input.valid = true;
  input.motor_position_rad = reading.motor_angle_rad + motor_offset_rad;
  input.output_position_rad = reading.output_angle_rad;
  input.output_velocity_rad_s = reading.output_velocity_rad_s;
  input.pressure_bar = reading.chamber_pressure_bar;
  return input;
}

Contact TrueContact(const surrogate::RigTruth& truth) {
  return truth.contact == 0  ? Contact::kNone
         : truth.contact > 0 ? Contact::kUpper
                             : Contact::kLower;
}

surrogate::RigInput Drive(const RegimeCase& at, double gear_ratio, double time_s) {
  surrogate::RigInput input;
  if (at.motion == Motion::kHand) {
    const double push = std::sin(2.0 * std::numbers::pi * at.speed_rad_s * time_s);
    input.hand_force_N = push > 0.0 ? 14.0 * push : 0.0;
    return input;
  }
  const double stroke_rad = at.speed_rad_s < 0.02 ? 0.03 : 0.3;
  const double period_s = 4.0 * stroke_rad / at.speed_rad_s;
  const double u = std::fmod(time_s / period_s + 0.25, 1.0);
  input.drive.mode = types::ControlMode::kPosition;
  input.drive.position_rad = gear_ratio * stroke_rad * (u < 0.5 ? 4.0 * u - 1.0 : 3.0 - 4.0 * u);
  // The load goes through zero: from the hand's side of the play to the chamber's and back.
  input.hand_force_N = 8.0 * std::sin(2.0 * std::numbers::pi * 0.37 * time_s);
  return input;
}

}  // namespace

RegimeScore RunRegimeCase(const RegimeCase& at) {
  surrogate::RigParameters parameters = Parameters(at.pressure_bar, at.noise_rad, at.seed);
  parameters.rotor_locked = at.motion == Motion::kHand;
  surrogate::Rig rig(parameters);
  RegimeDetector detector(Config(parameters));
  RegimeScore score;
  score.at = at;
  std::vector<Contact> truth, found;
  std::vector<double> open_rad;
  const auto count = static_cast<long>(at.seconds / kCycle_s);
  for (long k = 0; k < count; ++k) {
    rig.Advance(Drive(at, parameters.gear.ratio, static_cast<double>(k) * kCycle_s), kCycle_s);
    const surrogate::RigReading reading = rig.Read();
    const surrogate::RigTruth real = rig.truth();
    const DetectorOutput out = detector.Step(Input(reading));
    score.unknown += out.regime == types::Regime::kUnknown;
    truth.push_back(TrueContact(real));
    found.push_back(out.contact);
    const double gap_rad = real.motor_angle_rad / parameters.gear.ratio - real.output_angle_rad;
    open_rad.push_back(0.5 * parameters.gear.play_rad - std::abs(gap_rad));
  }
  const auto size = truth.size();
  score.samples = static_cast<long>(size);
  std::vector<char> wrong(size, 0);
  for (std::size_t k = 1; k + 1 < size; ++k) {
    // It lies between two samples: one is the last before it, the other the first after it.
    const bool at_transition = truth[k] != truth[k - 1] || truth[k] != truth[k + 1];
    const bool hardly_open =
        truth[k] == Contact::kNone && std::min(open_rad[k], open_rad[k - 1]) < kOpen_rad;
    wrong[k] = !at_transition && !hardly_open && found[k] != truth[k];
    score.wrong += wrong[k];
    score.false_changes += wrong[k] && found[k] != found[k - 1];
  }
  // A state that lasts; it is found when the first sample that must be right is.
  for (std::size_t k = 1; k < size; ++k) {
    if (truth[k] == truth[k - 1]) continue;
    std::size_t end = k;
    while (end < size && truth[end] == truth[k]) ++end;
    // The first sample after the deadline: one sample, or two counts of opening.
    std::size_t due = k + 1;
    while (due < end && truth[k] == Contact::kNone &&
           std::min(open_rad[due], open_rad[due - 1]) < kOpen_rad) {
      ++due;
    }
    if (due + 1 >= end) continue;  // over before it had to be found
    ++score.transitions;
    score.found += found[due] == truth[k];
    std::size_t seen = due;
    while (seen < end && found[seen] != truth[k]) ++seen;
    if (seen == end) {
      ++score.never;
    } else {
      score.latest = std::max(score.latest, static_cast<long>(seen - due));
    }
  }
  return score;
}

SetupScore RunSetupCase(const SetupCase& at) {
  surrogate::RigParameters parameters = Parameters(at.pressure_bar, at.noise_rad, at.seed);
  surrogate::Rig rig(parameters);
  DetectorConfig config = Config(parameters);
  config.setup = regime::Setup::kActive;
  config.setup_pressure_bar = std::max(at.pressure_bar, kSetupPressure_bar);
  config.min_pressure_bar = kSetupPressure_bar;
  config.velocity_rad_s = kSetupVelocity_rad_s;
  RegimeDetector detector(config);
  SetupScore score;
  score.at = at;
  const double offset_motor_rad = parameters.gear.ratio * at.offset_rad;
  surrogate::RigInput input;
  input.valve_open = true;
  input.drive.mode = types::ControlMode::kPosition;
  for (long k = 0; k < 240 * 45; ++k) {
    rig.Advance(input, kCycle_s);
    const surrogate::RigReading reading = rig.Read();
    const DetectorOutput out = detector.Step(Input(reading, offset_motor_rad));
    score.trouble = out.trouble;
    if (detector.setup_done()) {
      score.done = true;
      score.seconds = static_cast<double>(k) * kCycle_s;
      break;
    }
    if (out.trouble != regime::Trouble::kNone) break;
    if (out.request == types::Motion::kPushAgainstChamber) {
      const double target_rad = parameters.gear.ratio * out.request_target_rad - offset_motor_rad;
      const double step_rad = parameters.gear.ratio * config.velocity_rad_s * kCycle_s;
      input.drive.position_rad +=
          std::clamp(target_rad - input.drive.position_rad, -step_rad, step_rad);
    }
  }
  score.reported_error_rad = detector.offset_error_rad();
  // Lower contact: motor / N - output = -play / 2 with aligned encoders.
  score.error_rad =
      score.done ? detector.offset_rad() - (at.offset_rad - 0.5 * parameters.gear.play_rad) : 0.0;
  return score;
}

std::vector<UnknownCase> RunUnknownCases() {
  struct Plan {
    const char* name;
    double center_rad;      // given to the detector
    double backlash_share;  // of the true one
    bool active;            // setup asked for, and not possible
    double slip_rad;        // of the motor's encoder after 5 s, at the output
    bool lost;              // samples are not valid after 5 s
    bool broken;            // not a number after 5 s
  };
  constexpr double kFrom_s = 5.0;
  const Plan plans[] = {
      {"no setup yet (disarmed)", 0.0, 1.0, true, 0.0, false, false},
      {"setup without pressure (2 bar)", 0.0, 1.0, true, 0.0, false, false},
      {"centre of the play wrong by 20 mrad", 0.02, 1.0, false, 0.0, false, false},
      {"centre of the play wrong by -20 mrad", -0.02, 1.0, false, 0.0, false, false},
      {"backlash given as half of what it is", 0.0, 0.5, false, 0.0, false, false},
      {"motor encoder slips by 40 mrad", 0.0, 1.0, false, 0.04, false, false},
      {"motor encoder slips by -40 mrad", 0.0, 1.0, false, -0.04, false, false},
      {"samples lost", 0.0, 1.0, false, 0.0, true, false},
      {"an angle is not a number", 0.0, 1.0, false, 0.0, false, true}};
  std::vector<UnknownCase> results;
  for (std::size_t p = 0; p < std::size(plans); ++p) {
    const Plan& plan = plans[p];
    surrogate::RigParameters parameters = Parameters(plan.active ? 2.0 : 4.0, 1.5e-4, 7 + p);
    surrogate::Rig rig(parameters);
    DetectorConfig config = Config(parameters);
    config.play.backlash_rad *= plan.backlash_share;
    config.play_center_rad = plan.center_rad;
    if (plan.active) {
      config.setup = regime::Setup::kActive;
      config.setup_pressure_bar = 5.0;
      config.min_pressure_bar = kSetupPressure_bar;
    }
    RegimeDetector detector(config);
    UnknownCase result;
    result.name = plan.name;
    long assessed = 0, unknown = 0;
    bool reported = false;
    RegimeCase motion;
    motion.speed_rad_s = 0.2;
    const double from_s = plan.slip_rad != 0.0 || plan.lost || plan.broken ? kFrom_s : 0.0;
    for (long k = 0; k < 240 * 20; ++k) {
      const double time_s = static_cast<double>(k) * kCycle_s;
      rig.Advance(Drive(motion, parameters.gear.ratio, time_s), kCycle_s);
      const bool later = time_s >= kFrom_s;
      DetectorInput input = Input(rig.Read(), later ? parameters.gear.ratio * plan.slip_rad : 0.0);
      input.armed = p != 0;
      if (later && plan.lost) input.valid = false;
      if (later && plan.broken) input.motor_position_rad = NAN;
      const bool is_unknown = detector.Step(input).regime == types::Regime::kUnknown;
      if (time_s < from_s) continue;
      if (is_unknown && !reported) {
        reported = true;
        result.reported_after_s = time_s - from_s;
      }
      if (!reported) continue;
      ++assessed;
      unknown += is_unknown;
    }
    result.unknown_share =
        assessed > 0 ? static_cast<double>(unknown) / static_cast<double>(assessed) : 0.0;
    results.push_back(result);
  }
  return results;
}

std::vector<RegimeCase> RegimeCases(bool quick) {
  const std::vector<double> pressures_bar =
      quick ? std::vector{2.0, 6.0} : std::vector{1.0, 2.0, 3.0, 4.0, 5.0, 6.0};
  const std::vector<double> noises_rad =
      quick ? std::vector{1.5e-4} : std::vector{0.0, 1.5e-4, 3e-4};
  const std::vector<double> speeds_rad_s =
      quick ? std::vector{0.002, 0.05, 1.0} : std::vector{0.002, 0.005, 0.02, 0.1, 0.4, 1.5};
  std::vector<RegimeCase> cases;
  std::uint64_t seed = 1;
  for (const double noise_rad : noises_rad) {
    for (const double pressure_bar : pressures_bar) {
      for (const double rate_Hz : {0.5, 2.0}) {
        cases.push_back({Motion::kHand, rate_Hz, pressure_bar, noise_rad, 20.0, seed++});
      }
      for (const double speed_rad_s : speeds_rad_s) {
        cases.push_back({Motion::kMotor, speed_rad_s, pressure_bar, noise_rad,
                         speed_rad_s < 0.01 ? 40.0 : 20.0, seed++});
      }
    }
  }
  return cases;
}

std::vector<SetupCase> SetupCases(bool quick) {
  std::vector<SetupCase> cases;
  std::uint64_t seed = 1;
  for (const double pressure_bar : quick ? std::vector{4.5} : std::vector{4.0, 5.0, 6.0}) {
    for (const double noise_rad : quick ? std::vector{1.5e-4} : std::vector{0.0, 1.5e-4, 3e-4}) {
      for (const double offset_rad : {-0.3, 0.0, 0.017}) {
        cases.push_back({pressure_bar, offset_rad, noise_rad, seed++});
      }
    }
  }
  return cases;
}

RegimeGrid MeasureRegime(bool quick, std::uint64_t seed,
                         const std::function<void(std::size_t, std::size_t)>& progress) {
  std::vector<RegimeCase> cases = RegimeCases(quick);
  std::vector<SetupCase> setups = SetupCases(quick);
  const std::size_t all = cases.size() + setups.size();
  std::size_t done = 0;
  const auto advance = [&] {
    ++done;
    if (progress) progress(done, all);
  };
  RegimeGrid grid;
  for (RegimeCase& at : cases) {
    at.seed += 1000 * (seed - 1);
    grid.scores.push_back(RunRegimeCase(at));
    advance();
  }
  for (SetupCase& at : setups) {
    at.seed += 1000 * (seed - 1);
    grid.setups.push_back(RunSetupCase(at));
    advance();
  }
  grid.unknowns = RunUnknownCases();
  return grid;
}

std::vector<NoiseLevel> ByNoise(const RegimeGrid& grid) {
  std::vector<NoiseLevel> levels;
  for (const RegimeScore& score : grid.scores) {
    auto level = std::find_if(levels.begin(), levels.end(), [&](const NoiseLevel& l) {
      return l.noise_rad == score.at.noise_rad;
    });
    if (level == levels.end())
      level = levels.insert(levels.end(), {score.at.noise_rad, {}, 1.0, 0});
    ++level->cases;
    level->worst_share = std::min(level->worst_share, score.right_share());
    level->sum.samples += score.samples;
    level->sum.wrong += score.wrong;
    level->sum.transitions += score.transitions;
    level->sum.found += score.found;
    level->sum.never += score.never;
    level->sum.false_changes += score.false_changes;
    level->sum.latest = std::max(level->sum.latest, score.latest);
  }
  return levels;
}

}  // namespace sinew::acceptance
