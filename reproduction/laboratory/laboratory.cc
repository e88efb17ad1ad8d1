#include "reproduction/laboratory/laboratory.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "components/base/types/angle.h"
#include "components/model/experiment/breakaway.h"
#include "components/model/experiment/catalogue.h"
#include "components/model/experiment/push.h"
#include "sim/surrogate/experiment.h"
#include "sim/surrogate/random.h"

namespace sinew::laboratory {
namespace {

using experiment::Command;
using experiment::Recording;
using experiment::Result;
using experiment::Row;
using surrogate::RigParameters;
using surrogate::RigTruth;

constexpr double kCycle_Hz = 240.0;
constexpr double kLongest_s = 3600.0;
constexpr std::uint64_t kStreamPlay = 400;
constexpr std::uint64_t kStreamTrials = 401;
constexpr double kUncoupledPlay_rad = 1e6;
constexpr double kPush_N = 1.0;  // of a push, beyond what moves the link, on the lower contact

// The rig as it stands when the protocol begins.
RigParameters AtStart(RigParameters rig, const experiment::Start& start) {
  rig.initial_angle_rad = start.output_angle_rad;
  rig.pneumatics.initial_pressure_bar = start.pressure_bar;
  rig.pneumatics.initial_valve_open = true;
  rig.initial_rest_s = start.rest_s;
  rig.rotor_locked = start.rotor_locked;
  if (start.motor_uncoupled) {
    // On the bench: no teeth to meet, and no gear to lose torque in.
    rig.gear.play_rad = kUncoupledPlay_rad;
    rig.gear.share_drive = rig.gear.share_back = 1.0;
    rig.link.gravity_torque_Nm = 0.0;
    rig.pneumatics.initial_pressure_bar = 0.0;
  }
  return rig;
}

Recording RunProtocol(const RigParameters& specimen, experiment::Protocol& protocol,
                      std::uint64_t seed, const surrogate::TruthFunction& truth,
                      double* simulated_s, const std::function<void(double)>& progress = {}) {
  RigParameters rig = AtStart(specimen, protocol.start());
  rig.seed = seed;
  double last_s = 0.0;
  const auto command = [&](double time_s, const provider::PlantSensors& sensors,
                           provider::PlantCommand* out, provider::Disturbance* disturbance) {
    experiment::Reading reading;
    reading.time_s = time_s;
    reading.motor_angle_rad = sensors.motor_position_rad[0];
    reading.motor_velocity_rad_s = sensors.motor_velocity_rad_s[0];
    reading.output_angle_rad = sensors.position_rad[0];
    reading.output_velocity_rad_s = sensors.velocity_rad_s[0];
    reading.motor_current_A = sensors.motor_current_A[0];
    reading.chamber_pressure_bar = sensors.chamber_pressure_bar[0];
    reading.reservoir_pressure_bar = sensors.reservoir_pressure_bar[0];
    reading.load_force_N = sensors.load_force_N[0];
    reading.valve_open = sensors.valve_open[0];
    const Command c = protocol.Step(reading);
    out->mode[0] = c.drive;
    out->motor_torque_Nm[0] = c.motor_torque_Nm;
    out->position_rad[0] = c.position_rad;
    out->valve_open[0] = c.valve_open;
    out->compressor_on[0] = c.compressor_on;
    out->vent_open[0] = c.vent_open;
    disturbance->hand_force_N[0] = c.hand_force_N;
    if (progress && time_s > last_s + 1.0) {
      progress(std::min(1.0, time_s / protocol.expected_s()));
      last_s = time_s;
    }
  };
  const std::vector<surrogate::LogRow> log = surrogate::RunExperiment(
      rig,
      {.duration_s = std::min(kLongest_s, 1.5 * protocol.expected_s() + 20.0),
       .cycle_Hz = kCycle_Hz,
       .log_every = 1,
       .seed = seed,
       .done = [&] { return protocol.done(); }},
      command, truth);
  Recording rows;
  rows.reserve(log.size());
  for (const surrogate::LogRow& row : log) {
    rows.push_back({row.time_s, row.motor_angle_rad, row.motor_velocity_rad_s, row.output_angle_rad,
                    row.output_velocity_rad_s, row.motor_current_A, row.chamber_pressure_bar,
                    row.reservoir_pressure_bar, row.load_force_N, row.valve_open});
  }
  if (simulated_s != nullptr && !rows.empty()) *simulated_s += rows.back().time_s;
  return rows;
}

int Trials(const Plan& plan, int full, int coverage, int quick) {
  if (plan.trials > 0) return plan.trials;
  return plan.size == Size::kFull ? full : plan.size == Size::kCoverage ? coverage : quick;
}

double Duration_s(const Plan& plan, double full, double quick) {
  return plan.size == Size::kQuick ? quick : full;
}

double SlopeAtLevel_Nm_bar(const RigParameters& rig) {
  const std::vector<double>& shape = rig.pneumatics.displacement_shape;
  const double place = 0.5 * static_cast<double>(shape.size() - 1);
  const auto cell = std::min(static_cast<std::size_t>(place), shape.size() - 2);
  const double share =
      shape[cell] + (place - static_cast<double>(cell)) * (shape[cell + 1] - shape[cell]);
  return rig.pneumatics.displacement_m3_rad * 1e5 * share;
}

// The greatest friction that the link's contacts bear after a minute's rest under a slow push,
// without any sensor.
double BorneFriction_Nm(const RigParameters& specimen) {
  experiment::BreakawayProtocol protocol({.angle_rad = 0.5 * std::numbers::pi});
  double largest_Nm = 0.0;
  (void)RunProtocol(
      specimen, protocol, 1,
      [&](const RigTruth& t) { largest_Nm = std::max(largest_Nm, std::abs(t.friction_torque_Nm)); },
      nullptr);
  return largest_Nm;
}

// A true value that the run itself gave is kept.
void SetTruth(Result* result, const std::string& id, double truth) {
  for (experiment::Quantity& quantity : result->quantities) {
    if (quantity.id == id && !quantity.truth) quantity.truth = truth;
  }
}

void SetSecants(const RigParameters& specimen, double travel_rad, Result* result) {
  const double slope_Nm_bar = SlopeAtLevel_Nm_bar(specimen);
  SetTruth(
      result, "secant_6bar_Nm_rad",
      (6.0 * slope_Nm_bar + specimen.link.friction.kinetic_Nm - specimen.link.gravity_torque_Nm) /
          travel_rad);
  SetTruth(result, "secant_slope_Nm_rad_bar", slope_Nm_bar / travel_rad);
}

Outcome RunBreakaway(const RigParameters& specimen, const Plan& plan,
                     const std::function<void(double)>& progress) {
  Outcome outcome;
  const int trials = Trials(plan, 100, 4, 10);
  surrogate::RandomStream random(plan.seed, kStreamTrials);
  std::vector<experiment::Breakaway> found;
  constexpr int kAngles = std::size(experiment::kBreakawayAngles_deg);
  int done = 0;
  for (const double angle_deg : experiment::kBreakawayAngles_deg) {
    for (int i = 0; i < trials; ++i) {
      // Nobody waits or presses exactly alike.
      experiment::BreakawayProtocol protocol({.angle_rad = angle_deg * types::kDegree_rad,
                                              .rest_s = random.Uniform(45.0, 90.0),
                                              .rate_N_s = random.Uniform(0.8, 1.4)});
      Recording rows =
          RunProtocol(specimen, protocol, random.Bits() | 1u, {}, &outcome.simulated_s);
      const std::vector<experiment::Breakaway> one = experiment::FindBreakaways(rows);
      found.insert(found.end(), one.begin(), one.end());
      if (i < 3) outcome.recordings.push_back(std::move(rows));
      if (progress) progress(static_cast<double>(++done) / (kAngles * trials));
    }
  }
  outcome.result = experiment::IdentifyBreakaway(found, plan.constants);
  return outcome;
}

Outcome RunStiffness(const RigParameters& specimen, const Plan& plan,
                     const std::function<void(double)>& progress) {
  Outcome outcome;
  experiment::PushProtocol protocol({.first_bar = 6.0,
                                     .last_bar = 1.2,
                                     .duration_s = Duration_s(plan, 180.0, 90.0),
                                     .shut_every = 3});
  std::vector<RigTruth> truth;
  outcome.recordings.push_back(RunProtocol(
      specimen, protocol, plan.seed, [&](const RigTruth& t) { truth.push_back(t); },
      &outcome.simulated_s, progress));
  const Recording& rows = outcome.recordings[0];
  outcome.result = experiment::IdentifyStiffness(rows, plan.constants);
  // The same rows without noise, with nothing but the gas on the load cell.
  Recording exact = rows;
  std::size_t k = 0;
  for (Row& row : exact) {
    while (k + 1 < truth.size() && truth[k].time_s < row.time_s) ++k;
    row.output_angle_rad = truth[k].output_angle_rad;
    row.load_force_N = truth[k].pneumatic_torque_Nm / plan.constants.link_length_m;
  }
  const experiment::Play play = experiment::FindStrokes(rows);
  const double length_m = plan.constants.link_length_m;
  SetTruth(&outcome.result, "gas_shut_Nm_rad", experiment::MeanSlope(exact, play, false, length_m));
  SetTruth(&outcome.result, "gas_open_Nm_rad", experiment::MeanSlope(exact, play, true, length_m));
  // The way from contact to contact that the link really went.
  const auto mean_rad = [&exact](const std::vector<std::size_t>& in) {
    double sum_rad = 0.0;
    for (const std::size_t i : in) sum_rad += exact[i].output_angle_rad;
    return sum_rad / static_cast<double>(in.size());
  };
  if (!play.upper_rows.empty() && !play.lower_rows.empty()) {
    SetSecants(specimen, mean_rad(play.upper_rows) - mean_rad(play.lower_rows), &outcome.result);
  }
  return outcome;
}

}  // namespace

RigParameters MakeSpecimen(const RigParameters& rig, double spread, std::uint64_t seed) {
  RigParameters specimen = rig;
  specimen.spread = spread;
  specimen.seed = seed;
  specimen = surrogate::Specimen(specimen);
  surrogate::RandomStream random(seed, kStreamPlay);
  specimen.gear.play_rad *= 1.0 + random.Uniform(-spread, spread);
  specimen.spread = 0.0;
  return specimen;
}

void FillTruth(const RigParameters& specimen, Result* result) {
  const double slope_Nm_bar = SlopeAtLevel_Nm_bar(specimen);
  const double gravity_Nm = specimen.link.gravity_torque_Nm;
  const double friction_Nm = specimen.link.friction.kinetic_Nm;
  SetTruth(result, "backlash_deg", specimen.gear.play_rad / types::kDegree_rad);
  SetTruth(result, "backlash_extremes_deg", specimen.gear.play_rad / types::kDegree_rad);
  SetTruth(result, "contact_compliance_deg_Nm",
           1.0 / specimen.gear.contact_stiffness_Nm_rad / types::kDegree_rad);
  if (result->Find("static_friction_Nm") != nullptr) {
    SetTruth(result, "static_friction_Nm", BorneFriction_Nm(specimen));
  }
  SetTruth(result, "gravity_Nm", gravity_Nm);
  SetTruth(result, "gravity_moving_Nm", gravity_Nm);
  SetTruth(result, "pressure_slope_Nm_bar", slope_Nm_bar);
  SetTruth(result, "pressure_slope_down_Nm_bar", slope_Nm_bar);
  SetTruth(result, "moving_friction_Nm", friction_Nm);
  SetTruth(result, "moving_friction_down_Nm", friction_Nm);
  // The way through the play, and into the teeth at both ends: resting on the upper contact,
  // pressed onto the lower one.
  const double contact_Nm_rad = specimen.gear.contact_stiffness_Nm_rad;
  const double travel_rad =
      specimen.gear.play_rad +
      (4.0 * slope_Nm_bar - gravity_Nm - friction_Nm + kPush_N * specimen.link.length_m) /
          contact_Nm_rad;
  SetSecants(specimen, travel_rad, result);
  SetTruth(result, "return_limit_bar", (friction_Nm + gravity_Nm) / slope_Nm_bar);
  SetTruth(result, "rotor_inertia_kg_m2", specimen.rotor.inertia_kg_m2);
  SetTruth(result, "rotor_inertia_published_kg_m2", specimen.rotor.inertia_kg_m2);
  SetTruth(result, "rotor_viscous_Nm_s_rad", specimen.rotor.viscous_Nm_s_rad);
  SetTruth(result, "rotor_viscous_published_Nm_s_rad", specimen.rotor.viscous_Nm_s_rad);
  SetTruth(result, "rotor_coulomb_Nm", specimen.rotor.friction.kinetic_Nm);
}

Outcome RunOnSurrogate(std::string_view name, const RigParameters& specimen, const Plan& plan,
                       const std::function<void(double)>& progress) {
  Outcome outcome;
  if (name == "breakaway") {
    outcome = RunBreakaway(specimen, plan, progress);
  } else if (name == "stiffness") {
    outcome = RunStiffness(specimen, plan, progress);
  } else {
    const bool backlash = name == "backlash";
    const auto protocol = experiment::MakeProtocol(
        name, {.trials = backlash ? Trials(plan, 100, 30, 20) : Trials(plan, 100, 20, 20),
               .quick = plan.size == Size::kQuick,
               .seed = plan.seed});
    outcome.recordings.push_back(
        RunProtocol(specimen, *protocol, plan.seed, {}, &outcome.simulated_s, progress));
    outcome.result = experiment::Identify(name, outcome.recordings.back(), plan.constants);
  }
  FillTruth(specimen, &outcome.result);
  return outcome;
}

}  // namespace sinew::laboratory
