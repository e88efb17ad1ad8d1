#include "components/robot/pneumatics/manager.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

namespace sinew::pneumatics {
namespace {

// The last of the air leaves ever more slowly: below this it counts as gone, or proves nothing.
constexpr double kEmpty_bar = 0.02;
constexpr double kNearlyEmpty_bar = 0.3;
// After a correction relays and filter need this long before the pressure speaks for itself.
constexpr double kRest_s = 0.3;
// Compressor and vent come to rest, and chamber and reservoir to one pressure, in these times.
constexpr double kComeToRest_s = 0.4;
constexpr double kEqualise_s = 0.6;

}  // namespace

const char* FaultText(Fault fault) noexcept {
  switch (fault) {
    case Fault::kNone:
      return "none";
    case Fault::kSensor:
      return "pressure sensor out of range";
    case Fault::kOverpressure:
      return "pressure above its limit";
    case Fault::kNoResponse:
      return "pressure does not respond: valve, compressor or vent is stuck";
    case Fault::kValve:
      return "the valve is not where it was commanded";
    case Fault::kLeak:
      return "pressure falls by itself: leak";
    case Fault::kRises:
      return "pressure rises by itself: compressor or valve is stuck on";
  }
  return "unknown";
}

PressureManager::PressureManager(const ManagerConfig& config)
    : config_(config),
      valve_(config.valve),
      compressor_(config.compressor),
      vent_(config.vent),
      target_bar_(config.target_bar),
      uses_reservoir_(config.hold_with == HoldWith::kChamber && config.reservoir_sensor) {
  const auto require = [](bool good, const char* what, double value) {
    if (!good || !std::isfinite(value)) {
      throw std::invalid_argument(std::string(what) + " is " + std::to_string(value));
    }
  };
  require(config.max_target_bar > 0.0, "largest target", config.max_target_bar);
  require(config.target_bar >= 0.0 && config.target_bar <= config.max_target_bar, "target",
          config.target_bar);
  require(config.band_bar > 0.0, "band", config.band_bar);
  require(config.start_band_bar > 0.0 && config.start_band_bar <= config.band_bar,
          "band at which a correction starts", config.start_band_bar);
  require(config.lead_s >= 0.0, "lead", config.lead_s);
  require(config.settle_s >= 0.0, "settling time", config.settle_s);
  require(config.calm_s >= 0.0, "calm time", config.calm_s);
  require(config.filter_Hz > 0.0, "filter", config.filter_Hz);
  require(config.sensor_lower_bar < config.sensor_upper_bar, "range of the sensor",
          config.sensor_lower_bar);
  require(config.sensor_upper_bar > config.max_pressure_bar, "upper end of the sensor",
          config.sensor_upper_bar);
  require(config.sensor_time_s >= 0.0, "sensor time", config.sensor_time_s);
  require(config.max_pressure_bar > config.max_target_bar, "pressure limit",
          config.max_pressure_bar);
  require(config.response_s > 0.0, "response time", config.response_s);
  require(config.response_bar > 0.0, "response", config.response_bar);
  require(config.feedback_time_s > 0.0, "feedback time", config.feedback_time_s);
  require(config.leak_limit_bar_s > 0.0, "leak limit", config.leak_limit_bar_s);
  require(config.leak_window_s > 0.0, "leak window", config.leak_window_s);
}

void PressureManager::Restart() noexcept {
  fault_ = Fault::kNone;
  mode_ = Mode::kIdle;
  known_ = false;
  bad_sensor_s_ = bad_reservoir_s_ = overpressure_s_ = feedback_s_ = still_s_ = correcting_s_ =
      leaking_s_ = 0.0;
  rest_change_bar_ = rest_time_s_ = 0.0;
  stage_ = Stage::kDirect;
  joined_ = false;
}

bool PressureManager::RequestPressure(double pressure_bar) noexcept {
  if (!std::isfinite(pressure_bar)) return false;
  target_bar_ = std::clamp(pressure_bar, 0.0, config_.max_target_bar);
  return true;
}

bool PressureManager::RequestStiffness(double stiffness_Nm_rad) noexcept {
  const std::optional<double> pressure_bar = config_.stiffness.Pressure_bar(stiffness_Nm_rad);
  return pressure_bar && RequestPressure(*pressure_bar);
}

double PressureManager::leak_bar_s() const noexcept {
  // Enough: a third of what the forgetting keeps at most.
  return rest_time_s_ > config_.leak_window_s / 3.0 ? -rest_change_bar_ / rest_time_s_ : 0.0;
}

// Filters and checks the samples; latches faults.
void PressureManager::Watch(const ManagerInput& input) noexcept {
  const double h = input.period_s;
  const bool in_range = input.chamber_bar >= config_.sensor_lower_bar &&
                        input.chamber_bar <= config_.sensor_upper_bar;  // false for NaN
  bad_sensor_s_ = in_range ? 0.0 : bad_sensor_s_ + h;
  if (!in_range) {
    if (bad_sensor_s_ > config_.sensor_time_s) fault_ = Fault::kSensor;
    return;  // the filter keeps what it knew
  }
  if (!known_) {
    known_ = true;
    chamber_ = {input.chamber_bar, 0.0};
    reservoir_ = {std::isfinite(input.reservoir_bar) ? input.reservoir_bar : 0.0, 0.0};
  }
  const double share = h / (h + 1.0 / (2.0 * std::numbers::pi * config_.filter_Hz));
  const double step_bar = chamber_.Step(input.chamber_bar, share, h);
  if (uses_reservoir_) {
    const bool good = input.reservoir_bar >= config_.sensor_lower_bar &&
                      input.reservoir_bar <= config_.sensor_upper_bar;
    bad_reservoir_s_ = good ? 0.0 : bad_reservoir_s_ + h;
    if (bad_reservoir_s_ > config_.sensor_time_s) fault_ = Fault::kSensor;
    if (good) reservoir_.Step(input.reservoir_bar, share, h);
  }

  overpressure_s_ = input.chamber_bar > config_.max_pressure_bar ? overpressure_s_ + h : 0.0;
  if (overpressure_s_ > config_.sensor_time_s) fault_ = Fault::kOverpressure;

  if (config_.valve_feedback && !input.standby) {
    feedback_s_ = input.valve_is_open != valve_.on() ? feedback_s_ + h : 0.0;
    if (feedback_s_ > config_.feedback_time_s) fault_ = Fault::kValve;
  }

  const bool at_rest = mode_ == Mode::kHold && still_s_ > kRest_s;
  if (at_rest) {
    const double keep = 1.0 - h / config_.leak_window_s;
    rest_change_bar_ = keep * rest_change_bar_ + step_bar;
    rest_time_s_ = keep * rest_time_s_ + h;
    // For half a window: after filling, air that cools looks like a leak for a while.
    const double leak = leak_bar_s();
    leaking_s_ = std::abs(leak) > config_.leak_limit_bar_s ? leaking_s_ + h : 0.0;
    if (leaking_s_ > 0.5 * config_.leak_window_s)
      fault_ = leak > 0.0 ? Fault::kLeak : Fault::kRises;
  }

  const bool moves_air = stage_ == Stage::kDirect || stage_ == Stage::kPrepare;
  if ((mode_ == Mode::kFill || mode_ == Mode::kVent) && moves_air) {
    correcting_s_ += h;
    const double now_bar = Moved().value_bar;
    const double moved_bar =
        mode_ == Mode::kFill ? now_bar - progress_bar_ : progress_bar_ - now_bar;
    const bool nearly_empty = mode_ == Mode::kVent && now_bar < kNearlyEmpty_bar;
    if (moved_bar >= config_.response_bar || nearly_empty) {
      correcting_s_ = 0.0;
      progress_bar_ = now_bar;
    } else if (correcting_s_ > config_.response_s) {
      fault_ = Fault::kNoResponse;
    }
  }
}

const PressureManager::Filtered& PressureManager::Moved() const noexcept {
  return uses_reservoir_ && !joined_ ? reservoir_ : chamber_;
}

double PressureManager::Filtered::Step(double sample_bar, double share, double period_s) noexcept {
  const double step_bar = share * (sample_bar - value_bar);
  value_bar += step_bar;
  rate_bar_s += share * (step_bar / period_s - rate_bar_s);
  return step_bar;
}

// The chamber is off its target: which way, and by which steps.
void PressureManager::StartCorrection() noexcept {
  const Filtered& moved = Moved();
  const double error_bar = target_bar_ - moved.value_bar;
  mode_ = error_bar > 0.0 ? Mode::kFill : Mode::kVent;
  stage_ = uses_reservoir_ && !joined_ ? Stage::kPrepare : Stage::kDirect;
  stage_s_ = correcting_s_ = 0.0;
  progress_bar_ = moved.value_bar;
  if (stage_ == Stage::kPrepare && std::abs(error_bar) < 0.5 * config_.start_band_bar) {
    stage_ = Stage::kEqualise;  // the reservoir is where the chamber should be
  }
}

void PressureManager::Correct(double period_s) noexcept {
  if (mode_ == Mode::kIdle || mode_ == Mode::kSafe) {
    mode_ = Mode::kHold;
    still_s_ = config_.settle_s;  // may correct at once
  } else if (mode_ == Mode::kHold) {
    still_s_ += period_s;
    joined_ = joined_ && still_s_ < config_.calm_s;
  }
  if (mode_ == Mode::kHold) {
    const bool off = std::abs(target_bar_ - chamber_.value_bar) > config_.start_band_bar;
    if (off && still_s_ >= config_.settle_s) StartCorrection();
    return;
  }
  stage_s_ += period_s;
  bool done = false;
  if (stage_ == Stage::kDirect || stage_ == Stage::kPrepare) {
    const Filtered& moved = Moved();
    const double expected_bar = moved.value_bar + config_.lead_s * moved.rate_bar_s;
    const bool reached = mode_ == Mode::kFill ? expected_bar >= target_bar_
                                              : expected_bar <= std::max(target_bar_, kEmpty_bar);
    done = reached && stage_ == Stage::kDirect;
    if (reached && stage_ == Stage::kPrepare) {
      stage_ = Stage::kComeToRest;
      stage_s_ = 0.0;
    }
  } else if (stage_ == Stage::kComeToRest && stage_s_ >= kComeToRest_s) {
    stage_ = Stage::kEqualise;
    stage_s_ = 0.0;
  } else if (stage_ == Stage::kEqualise && stage_s_ >= kEqualise_s) {
    done = joined_ = true;
    // Joined, they have one pressure; where they have not, the valve did not open.
    if (std::abs(chamber_.value_bar - reservoir_.value_bar) > 2.0 * config_.response_bar) {
      fault_ = Fault::kNoResponse;
    }
  }
  if (done) {
    mode_ = Mode::kHold;
    // Coming to rest and joining was rest enough.
    still_s_ = stage_ == Stage::kEqualise ? config_.settle_s : 0.0;
    stage_ = Stage::kDirect;
  }
}

ManagerOutput PressureManager::AllOff(Mode mode, bool let_out) noexcept {
  mode_ = mode;
  joined_ = false;
  compressor_.Force(false);
  valve_.Force(let_out);
  vent_.Force(let_out);
  ManagerOutput output;
  output.mode = mode;
  output.valve_open = output.vent_open = let_out;
  return output;
}

ManagerOutput PressureManager::Drive(double period_s) noexcept {
  const bool moves_air = stage_ == Stage::kDirect || stage_ == Stage::kPrepare;
  const bool fill = mode_ == Mode::kFill && moves_air;
  const bool vent = mode_ == Mode::kVent && moves_air;
  const bool valve = config_.hold_with == HoldWith::kReservoir ||
                     (uses_reservoir_ ? joined_ || stage_ == Stage::kEqualise : fill || vent);
  ManagerOutput output;
  output.mode = mode_;
  output.compressor_on = compressor_.Step(fill && !vent_.on(), period_s);
  output.vent_open = vent_.Step(vent && !compressor_.on(), period_s);
  output.valve_open = valve_.Step(valve, period_s);
  return output;
}

ManagerOutput PressureManager::Step(const ManagerInput& input) noexcept {
  if (input.reset) {
    const double target_bar = target_bar_;
    Restart();
    target_bar_ = target_bar;
  }
  const bool usable = input.valid && input.period_s > 0.0;
  if (usable) Watch(input);

  ManagerOutput output;
  if (fault_ != Fault::kNone) {
    output = AllOff(Mode::kSafe, config_.vent_when_safe);
  } else if (input.standby) {
    output = AllOff(Mode::kHold, false);
    valve_.Force(input.valve_is_open);
    output.valve_open = valve_.on();
    still_s_ = feedback_s_ = 0.0;
  } else if (!input.active) {
    output = AllOff(Mode::kIdle, config_.vent_when_idle);
  } else if (!usable || !known_ || bad_sensor_s_ > 0.0) {
    // For a moment nothing is known: what runs is stopped, without counting as a correction.
    compressor_.Force(false);
    vent_.Force(false);
    if (mode_ == Mode::kFill || mode_ == Mode::kVent) mode_ = Mode::kHold;
    stage_ = Stage::kDirect;
    output.mode = mode_;
    output.valve_open = valve_.on();
  } else {
    Correct(input.period_s);
    output = fault_ == Fault::kNone ? Drive(input.period_s)
                                    : AllOff(Mode::kSafe, config_.vent_when_safe);
  }
  output.fault = fault_;
  output.target_bar = target_bar_;
  output.pressure_bar = chamber_.value_bar;
  output.stiffness_Nm_rad = config_.stiffness.Stiffness_Nm_rad(chamber_.value_bar);
  output.sensor_fault = fault_ == Fault::kSensor || bad_sensor_s_ > 0.0;
  output.settled = output.mode == Mode::kHold && usable && bad_sensor_s_ == 0.0 &&
                   std::abs(target_bar_ - chamber_.value_bar) <= config_.band_bar;
  return output;
}

}  // namespace sinew::pneumatics
