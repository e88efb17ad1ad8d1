// sinew-tune-pid: finds PID gains in process, against the surrogate, by a two-stage random search.
//
// Objective: mean squared tracking error of the reference's trajectories at 3 and 5 bar, without
// and with a payload. Constraint: with every gain four times as large (12 dB of gain margin) no run
// swings. Both in the laboratory's loop: 80 Hz, commands one period late. Stage 1 draws from the
// whole ranges, stage 2 around the best (search.h).
#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdio>
#include <iostream>

#include "components/robot/control/file/control_file.h"
#include "components/robot/pneumatics/file/pneumatics_file.h"
#include "components/robot/reference/file/reference_file.h"
#include "sim/surrogate/file/surrogate_file.h"
#include "sim/surrogate/surrogate.h"
#include "tools/tune_pid/closed_loop.h"
#include "tools/tune_pid/search.h"

namespace {

using namespace sinew;

constexpr double kMargin = 4.0;
constexpr double kSwing_Nm = 5e-3;  // change of motor torque from tick to tick, root mean square
constexpr double kLost_rad = 1.0;

struct Bench {
  surrogate::RigParameters rig;
  control::JointControlConfig joint;
  reference::RobotReferenceConfig reference;
  std::vector<pneumatics::ManagerConfig> pneumatics;
  double duration_s = 0.0;

  tune::ClosedLoopScore Run(const control::PidConfig& pid, double pressure_bar, double payload_kg,
                            double rate_Hz, int delay_ticks) const {
    surrogate::RigParameters parameters = rig;
    parameters.link.declared_payload_kg = payload_kg;
    parameters.pneumatics.initial_pressure_bar = pressure_bar;
    surrogate::Surrogate plant(parameters);
    tune::ClosedLoopConfig loop;
    loop.control = {joint};
    loop.control[0].pid = pid;
    loop.reference = reference;
    loop.pneumatics = pneumatics;
    for (auto& air : loop.pneumatics) air.target_bar = pressure_bar;
    loop.rate_Hz = rate_Hz;
    loop.delay_ticks = delay_ticks;
    loop.duration_s = duration_s;
    loop.score_from_s = 0.5;
    return tune::RunClosedLoop(loop, plant);
  }
};

// The mean squared error; discarded where the constraint fails.
double Cost(const Bench& bench, const control::PidConfig& pid, double best) {
  double sum = 0.0;
  for (const double pressure_bar : {3.0, 5.0}) {
    for (const double payload_kg : {0.0, 0.5}) {
      sum += tune::TrackingCost(bench.Run(pid, pressure_bar, payload_kg, 80.0, 1)) / 4.0;
      if (!(sum < best)) return tune::kDiscarded;
    }
  }
  control::PidConfig harder = pid;
  for (const tune::Gain& gain : tune::kGains) harder.*gain.of *= kMargin;
  for (const double payload_kg : {0.0, 0.5}) {
    const tune::ClosedLoopScore score = bench.Run(harder, 4.0, payload_kg, 80.0, 1);
    if (score.faulted || !(score.torque_change_rms_Nm < kSwing_Nm) ||
        !(score.worst_rad < kLost_rad)) {
      return tune::kDiscarded;
    }
  }
  return sum;
}

}  // namespace

int main(int argc, char** argv) try {
  CLI::App app{"Finds PID gains against the surrogate, in process."};
  std::filesystem::path rig_path, control_path, reference_path, pneumatics_path;
  tune::SearchConfig search;
  app.add_option("--surrogate", rig_path, "Surrogate, schema sinew-surrogate/1");
  app.add_option("--control", control_path, "Controller whose gains are sought, sinew-control/1")
      ->required();
  app.add_option("--reference", reference_path, "Trajectories to tune on, sinew-reference/1")
      ->required();
  app.add_option("--pneumatics", pneumatics_path, "Pressure manager, sinew-pneumatics/1")
      ->required();
  app.add_option("--trials", search.trials, "Draws in each of the two stages")
      ->check(CLI::PositiveNumber);
  app.add_option("--seed", search.seed, "Seed of the draws");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  Bench bench;
  const config::Section rig_file = surrogate::OpenSurrogate(rig_path);
  bench.rig = surrogate::ReadRig(rig_file);
  bench.joint = control::LoadControl(control_path).joints.at(0);
  bench.joint.tracking_error_limit_rad = 0.0;  // the error is what candidates are assessed by
  bench.reference = reference::LoadReference(reference_path).config;
  bench.pneumatics = pneumatics::LoadPneumatics(pneumatics_path).joints;
  const reference::GeneratorConfig& trajectory = bench.reference.joints.at(0);
  if (!std::isfinite(trajectory.trajectory->duration_s())) {
    throw UsageError(reference_path.string() +
                     ": the trajectory never ends, expected one that does");
  }
  bench.duration_s =
      bench.reference.start_delay_s + trajectory.soft_start_s + trajectory.trajectory->duration_s();

  const auto print = [](const tune::Draw& draw) {
    std::printf(
        "stage %d draw %3d: Kp %7.3f Nm/rad  Ki %7.3f Nm/(rad s)  Kd %6.3f Nm s/rad  MSE %.6f "
        "rad2\n",
        draw.stage, draw.number, draw.pid.proportional_Nm_rad, draw.pid.integral_Nm_rad_s,
        draw.pid.derivative_Nm_s_rad, draw.cost);
    std::fflush(stdout);
  };
  const auto cost = [&bench](const control::PidConfig& pid, double best) {
    return Cost(bench, pid, best);
  };
  const auto found = tune::SearchGains(search, bench.joint.pid, cost, print);
  if (!found) {
    std::cerr << "no draw kept the margin; try more --trials\n";
    return 1;
  }
  const control::PidConfig& best_pid = found->pid;
  std::printf(
      "pid: {proportional_Nm_rad: %.4g, integral_Nm_rad_s: %.4g, derivative_Nm_s_rad: %.4g, "
      "derivative_filter_Hz: %g, anti_windup_s: %g}\n",
      best_pid.proportional_Nm_rad, best_pid.integral_Nm_rad_s, best_pid.derivative_Nm_s_rad,
      best_pid.derivative_filter_Hz, best_pid.anti_windup_s);
  return 0;
} catch (const sinew::UsageError& error) {
  std::cerr << error.what() << '\n';
  return 2;
} catch (const std::exception& error) {
  std::cerr << error.what() << '\n';
  return 1;
}
