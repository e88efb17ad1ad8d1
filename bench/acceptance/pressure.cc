#include "bench/acceptance/pressure.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numbers>

#include "bench/acceptance/rig_cycle.h"
#include "components/base/types/control_mode.h"
#include "sim/surrogate/rig.h"

namespace sinew::acceptance {
namespace {

using pneumatics::Fault;
using pneumatics::ManagerConfig;
using pneumatics::ManagerInput;
using pneumatics::ManagerOutput;
using pneumatics::PressureManager;

constexpr double kAfterSettling_s = 0.5;
constexpr double kBreaksAt_s = 20.0;
constexpr double kFaultRun_s = 60.0;
// Lets the chamber's air out in some seconds: the seal has gone.
constexpr double kHole_m3_sPa = 2e-10;

// Times between the switches of a relay.
class Stopwatch {
 public:
  void Step(bool on, double min_on_s, double min_off_s) {
    if (known_ && on != on_) {
      if (switched_) {
        double& shortest_s = on_ ? shortest_on_s_ : shortest_off_s_;
        shortest_s = std::min(shortest_s, since_s_ - (on_ ? min_on_s : min_off_s));
      }
      switched_ = true;
      ++switches_;
      since_s_ = 0.0;
    }
    known_ = true;
    on_ = on;
    since_s_ += kCycle_s;
  }
  double shortest_on_s() const { return shortest_on_s_; }
  double shortest_off_s() const { return shortest_off_s_; }
  long switches() const { return switches_; }

 private:
  bool known_ = false, switched_ = false, on_ = false;
  double since_s_ = 0.0;
  double shortest_on_s_ = std::numeric_limits<double>::infinity();
  double shortest_off_s_ = std::numeric_limits<double>::infinity();
  long switches_ = 0;
};

// What the manager senses of the rig, and what the rig's relays are set to.
ManagerInput Sense(const surrogate::RigReading& reading) {
  ManagerInput sensed;
  sensed.period_s = kCycle_s;
  sensed.active = sensed.valid = true;
  sensed.chamber_bar = reading.chamber_pressure_bar;
  sensed.reservoir_bar = reading.reservoir_pressure_bar;
  sensed.valve_is_open = reading.valve_open;
  return sensed;
}
void Obey(const ManagerOutput& out, surrogate::RigInput* input) {
  input->valve_open = out.valve_open;
  input->compressor_on = out.compressor_on;
  input->vent_open = out.vent_open;
}

bool IsFaultOf(Breakage breakage, Fault fault) {
  switch (breakage) {
    case Breakage::kNothing:
      return fault == Fault::kNone;
    case Breakage::kLeak:
      return fault == Fault::kLeak;
    case Breakage::kValveStuckShut:
    case Breakage::kValveStuckOpen:
      return fault == Fault::kValve;
    case Breakage::kValveStuckMute:
    case Breakage::kCompressorDead:
    case Breakage::kVentStuckShut:
      return fault == Fault::kNoResponse;
    case Breakage::kCompressorStuck:  // rises, or venting does not help: both name it
      return fault == Fault::kRises || fault == Fault::kNoResponse;
    case Breakage::kSensorHigh:
    case Breakage::kSensorLow:
    case Breakage::kSensorBroken:
      return fault == Fault::kSensor;
  }
  return false;
}

}  // namespace

HoldScore RunHoldCase(const ManagerConfig& config, const HoldCase& at) {
  surrogate::RigParameters parameters;
  parameters.pneumatics.initial_pressure_bar = at.from_bar;
  parameters.seed = at.seed;
  surrogate::Rig rig(parameters);
  ManagerConfig own = config;
  own.hold_with = at.hold_with;
  PressureManager manager(own);
  HoldScore score;
  score.at = at;
  const bool known = at.target_stiffness_Nm_rad > 0.0
                         ? manager.RequestStiffness(at.target_stiffness_Nm_rad)
                         : manager.RequestPressure(at.target_bar);
  if (!known) return score;
  score.target_bar = manager.target_bar();
  std::array<Stopwatch, 3> relays;
  long switches_before = 0;
  auto last_correction = pneumatics::Mode::kIdle;
  surrogate::RigInput input;
  input.drive.mode = types::ControlMode::kPosition;
  const auto count = static_cast<long>(at.seconds / kCycle_s);
  for (long k = 0; k < count; ++k) {
    const double time_s = static_cast<double>(k) * kCycle_s;
    ManagerInput sensed = Sense(rig.Read());
    const ManagerOutput out = manager.Step(sensed);
    score.fault = out.fault;
    if (out.settled && !score.settled) {
      score.settled = true;
      score.reached_s = time_s;
    }
    if (score.settled && time_s >= score.reached_s + kAfterSettling_s) {
      if (switches_before == 0) switches_before = manager.switches();
      if (out.mode == pneumatics::Mode::kFill || out.mode == pneumatics::Mode::kVent) {
        score.reversals +=
            last_correction != pneumatics::Mode::kIdle && last_correction != out.mode;
        last_correction = out.mode;
      }
      score.worst_bar =
          std::max(score.worst_bar, std::abs(rig.truth().chamber_pressure_bar - score.target_bar));
    }
    relays[0].Step(out.valve_open, own.valve.min_on_s, own.valve.min_off_s);
    relays[1].Step(out.compressor_on, own.compressor.min_on_s, own.compressor.min_off_s);
    relays[2].Step(out.vent_open, own.vent.min_on_s, own.vent.min_off_s);
    Obey(out, &input);
    if (at.moving) {
      const double rise = std::min(1.0, time_s / 5.0);
      input.drive.position_rad = parameters.gear.ratio * rise * std::numbers::pi / 6.0 *
                                 std::sin(2.0 * std::numbers::pi * 0.4 * time_s);
    }
    rig.Advance(input, kCycle_s);
  }
  score.shortest_on_s = score.shortest_off_s = std::numeric_limits<double>::infinity();
  for (const Stopwatch& relay : relays) {
    score.shortest_on_s = std::min(score.shortest_on_s, relay.shortest_on_s());
    score.shortest_off_s = std::min(score.shortest_off_s, relay.shortest_off_s());
  }
  const double held_s = at.seconds - score.reached_s - kAfterSettling_s;
  if (score.settled && held_s > 0.0) {
    score.switches_per_min =
        60.0 * static_cast<double>(manager.switches() - switches_before) / held_s;
  }
  return score;
}

const char* BreakageTitle(Breakage breakage) {
  switch (breakage) {
    case Breakage::kNothing:
      return "nothing breaks";
    case Breakage::kLeak:
      return "the seal leaks";
    case Breakage::kValveStuckShut:
      return "valve falls shut";
    case Breakage::kValveStuckOpen:
      return "valve stays open (shut chamber)";
    case Breakage::kValveStuckMute:
      return "valve shut, its contact says open";
    case Breakage::kCompressorDead:
      return "compressor dead, 5 bar asked for";
    case Breakage::kCompressorStuck:
      return "compressor does not stop";
    case Breakage::kVentStuckShut:
      return "vent stuck shut, 3 bar asked for";
    case Breakage::kSensorHigh:
      return "sensor at its upper end";
    case Breakage::kSensorLow:
      return "sensor at its lower end";
    case Breakage::kSensorBroken:
      return "sensor gives no number";
  }
  return "unknown";
}

std::vector<Breakage> Breakages() {
  return {Breakage::kNothing,         Breakage::kLeak,           Breakage::kValveStuckShut,
          Breakage::kValveStuckOpen,  Breakage::kValveStuckMute, Breakage::kCompressorDead,
          Breakage::kCompressorStuck, Breakage::kVentStuckShut,  Breakage::kSensorHigh,
          Breakage::kSensorLow,       Breakage::kSensorBroken};
}

FaultScore RunFaultCase(const ManagerConfig& config, Breakage breakage) {
  ManagerConfig own = config;
  own.target_bar = 4.0;
  if (breakage == Breakage::kValveStuckOpen) own.hold_with = pneumatics::HoldWith::kChamber;
  if (breakage == Breakage::kValveStuckMute) own.hold_with = pneumatics::HoldWith::kChamber;
  surrogate::RigParameters parameters;
  surrogate::Rig rig(parameters);
  // A leak is a rig of its own: the hole is there from the start, the manager holds from then on.
  if (breakage == Breakage::kLeak) {
    parameters.pneumatics.seal_leak.conductance_m3_sPa = kHole_m3_sPa;
    own.hold_with = pneumatics::HoldWith::kChamber;
    rig = surrogate::Rig(parameters);
  }
  PressureManager manager(own);
  FaultScore score;
  score.breakage = breakage;
  const double breaks_at_s = breakage == Breakage::kLeak ? 0.0 : kBreaksAt_s;
  bool reported = false;
  bool stays_safe = true;
  surrogate::RigInput input;
  for (long k = 0; k < static_cast<long>(kFaultRun_s / kCycle_s); ++k) {
    const double time_s = static_cast<double>(k) * kCycle_s;
    const bool broken = time_s >= breaks_at_s;
    ManagerInput sensed = Sense(rig.Read());
    if (broken && breakage == Breakage::kSensorHigh) sensed.chamber_bar = 9.99;
    if (broken && breakage == Breakage::kSensorLow) sensed.chamber_bar = -0.5;
    if (broken && breakage == Breakage::kSensorBroken) sensed.chamber_bar = NAN;
    if (broken && breakage == Breakage::kValveStuckShut) sensed.valve_is_open = false;
    if (broken && breakage == Breakage::kValveStuckOpen) sensed.valve_is_open = true;
    if (broken && breakage == Breakage::kValveStuckMute) sensed.valve_is_open = input.valve_open;
    if (time_s >= breaks_at_s && time_s < breaks_at_s + kCycle_s) {
      double asked_bar = 4.0;
      if (breakage == Breakage::kCompressorDead || breakage == Breakage::kValveStuckMute) {
        asked_bar = 5.0;
      } else if (breakage == Breakage::kVentStuckShut) {
        asked_bar = 3.0;
      }
      static_cast<void>(manager.RequestPressure(asked_bar));
    }
    const ManagerOutput out = manager.Step(sensed);
    if (out.fault != Fault::kNone && !reported) {
      reported = true;
      score.fault = out.fault;
      score.reported_after_s = time_s - breaks_at_s;
    }
    if (reported) {
      stays_safe = stays_safe && out.mode == pneumatics::Mode::kSafe && !out.compressor_on &&
                   out.valve_open == own.vent_when_safe && out.vent_open == own.vent_when_safe;
    }
    if (broken) score.highest_bar = std::max(score.highest_bar, rig.truth().chamber_pressure_bar);
    Obey(out, &input);
    surrogate::RigInput real = input;
    if (broken) {
      if (breakage == Breakage::kValveStuckShut || breakage == Breakage::kValveStuckMute) {
        real.valve_open = false;
      }
      if (breakage == Breakage::kValveStuckOpen) real.valve_open = true;
      if (breakage == Breakage::kCompressorDead) real.compressor_on = false;
      // A relay that welds stays closed after it is switched off, until power is
      // cut.
      if (breakage == Breakage::kCompressorStuck) real.compressor_on = !reported;
      if (breakage == Breakage::kVentStuckShut) real.vent_open = false;
    }
    rig.Advance(real, kCycle_s);
  }
  score.safe = reported && stays_safe;
  return score;
}

std::vector<HoldCase> HoldCases(bool quick) {
  std::vector<HoldCase> cases;
  std::uint64_t seed = 1;
  const double seconds = quick ? 40.0 : 120.0;
  for (const auto hold_with : {pneumatics::HoldWith::kReservoir, pneumatics::HoldWith::kChamber}) {
    for (const double target_bar :
         quick ? std::vector{2.0, 6.0} : std::vector{1.0, 2.0, 3.0, 4.0, 5.0, 6.0}) {
      cases.push_back({hold_with, 1.5, target_bar, 0.0, false, seconds, seed++});
    }
    // Downward, through the vent.
    cases.push_back({hold_with, 6.0, 4.5, 0.0, false, seconds, seed++});
  }
  // The link moves the reservoir's air by little; that of a shut chamber by much.
  for (const double target_bar : quick ? std::vector{4.0} : std::vector{2.0, 4.0, 6.0}) {
    cases.push_back(
        {pneumatics::HoldWith::kReservoir, 1.5, target_bar, 0.0, true, seconds, seed++});
  }
  for (const double stiffness_Nm_rad : quick ? std::vector{25.0} : std::vector{12.0, 20.0, 30.0}) {
    cases.push_back(
        {pneumatics::HoldWith::kReservoir, 1.5, 0.0, stiffness_Nm_rad, false, seconds, seed++});
  }
  return cases;
}

PressureCheck MeasurePressure(const ManagerConfig& config, bool quick, std::uint64_t seed,
                              const std::function<void(std::size_t, std::size_t)>& progress) {
  std::vector<HoldCase> cases = HoldCases(quick);
  const std::vector<Breakage> breakages = Breakages();
  const std::size_t all = cases.size() + breakages.size();
  std::size_t done = 0;
  const auto advance = [&] {
    ++done;
    if (progress) progress(done, all);
  };
  PressureCheck check;
  for (HoldCase& at : cases) {
    at.seed += 1000 * (seed - 1);
    check.holds.push_back(RunHoldCase(config, at));
    advance();
  }
  for (const Breakage breakage : breakages) {
    check.faults.push_back(RunFaultCase(config, breakage));
    advance();
  }
  return check;
}

bool IsRight(const FaultScore& score) {
  return IsFaultOf(score.breakage, score.fault) &&
         (score.breakage == Breakage::kNothing || score.safe);
}

}  // namespace sinew::acceptance
