#include "components/model/experiment/motor.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "components/base/types/angle.h"
#include "components/base/types/control_mode.h"
#include "components/model/identify/differentiate.h"
#include "components/model/identify/iir_filter.h"
#include "components/model/identify/uniform.h"

namespace sinew::experiment {
namespace {

constexpr double kCutoff_Hz = 12.0;
constexpr double kBorder_s = 0.5;
constexpr double kBlock_s = 1.0;
constexpr double kSlow_rad_s = 15.0;   // rows slower than this are left out of the second fit
constexpr double kCoupled_rad = 0.01;  // the output moved
constexpr double kShortest_s = 8.0;

void RequireUncoupled(const Recording& rows) {
  double lowest_rad = 1e9, highest_rad = -1e9;
  for (const Row& row : rows) {
    lowest_rad = std::min(lowest_rad, row.output_angle_rad);
    highest_rad = std::max(highest_rad, row.output_angle_rad);
  }
  if (highest_rad - lowest_rad > kCoupled_rad) {
    throw std::invalid_argument(
        "motor: the output moved by " +
        std::to_string((highest_rad - lowest_rad) * 180.0 / std::numbers::pi) +
        " degrees, expected a motor uncoupled from the link");
  }
}

// Differences of rows.
Eigen::Vector2d Published(const Recording& rows, const RigConstants& rig) {
  Eigen::Matrix2d G = Eigen::Matrix2d::Zero();
  Eigen::Vector2d m = Eigen::Vector2d::Zero();
  for (std::size_t i = 1; i < rows.size(); ++i) {
    const double dt_s = rows[i].time_s - rows[i - 1].time_s;
    if (!(dt_s > 0.0)) continue;
    const Eigen::Vector2d a(
        (rows[i].motor_velocity_rad_s - rows[i - 1].motor_velocity_rad_s) / dt_s,
        rows[i].motor_velocity_rad_s);
    G += a * a.transpose();
    m += a * rig.torque_constant_Nm_A * rows[i].motor_current_A;
  }
  return G.inverse() * m;
}

types::Run RunOf(const Recording& rows) {
  types::Run run;
  run.name = "motor";
  const auto n = static_cast<Eigen::Index>(rows.size());
  run.time_s.resize(n);
  Eigen::VectorXd angle(n), current(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Row& row = rows[static_cast<std::size_t>(i)];
    run.time_s(i) = row.time_s;
    angle(i) = row.motor_angle_rad;
    current(i) = row.motor_current_A;
  }
  // The position decides whether stamps or row numbers are right: here that is the motor's.
  run.signals[types::Signal::kPosition] = angle;
  run.signals[types::Signal::kMotorCurrent] = current;
  return run;
}

// fit: with Coulomb friction.
std::vector<Quantity> Quantities(const TrialFit& fit, const Eigen::Vector2d& published) {
  return {Quantity{"rotor_inertia_kg_m2", "J_m", "kg m2", fit.At(0), "with Coulomb friction"}
              .WithinShare(0.05),
          Quantity{"rotor_viscous_Nm_s_rad", "B_m", "Nm s/rad", fit.At(1), "with Coulomb friction"}
              .WithinShare(0.05),
          Quantity{"rotor_coulomb_Nm", "T_c", "Nm", fit.At(2), "dry friction of the rotor"},
          Quantity{"rotor_inertia_published_kg_m2", "J_m, by (4.21)-(4.26)", "kg m2",
                   Estimate{published(0), 0.0, 1},
                   "without Coulomb friction, differences of rows; x 3/2 with the printed factor"}
              .WithinShare(0.05)
              .WithoutInterval(),
          Quantity{"rotor_viscous_published_Nm_s_rad", "B_m, by (4.21)-(4.26)", "Nm s/rad",
                   Estimate{published(1), 0.0, 1},
                   "takes up the dry friction; x 3/2 with the printed factor"}
              .WithinShare(0.05)
              .WithoutInterval()};
}

}  // namespace

MotorProtocol::MotorProtocol(const MotorPlan& plan) : plan_(plan) {
  if (!(plan.duration_s > 0.0) || !(plan.torque_Nm > 0.0) || plan.sines < 2 ||
      !(plan.lowest_Hz > 0.0) || !(plan.highest_Hz > plan.lowest_Hz)) {
    throw std::invalid_argument("motor: duration, torque, sines and frequencies must make sense");
  }
  Person person(plan.seed);
  for (int i = 0; i < plan.sines; ++i) {
    const double share = static_cast<double>(i) / (plan.sines - 1);
    const double frequency_Hz = plan.lowest_Hz * std::pow(plan.highest_Hz / plan.lowest_Hz, share);
    sines_.push_back({types::kTwoPi * frequency_Hz, person.Uniform(0.0, types::kTwoPi),
                      plan.torque_Nm * std::sqrt(2.0 / plan.sines)});
  }
}

Command MotorProtocol::Step(const Reading& reading) noexcept {
  Command command;
  const double t = reading.time_s;
  if (t >= plan_.duration_s) {
    done_ = true;
    return command;
  }
  command.drive = types::ControlMode::kTorque;
  command.valve_open = false;
  double sum_Nm = 0.0;
  for (const Sine& s : sines_) sum_Nm += s.torque_Nm * std::sin(s.rad_s * t + s.phase_rad);
  const double edge = std::clamp(std::min(t, plan_.duration_s - t) / plan_.ramp_s, 0.0, 1.0);
  command.motor_torque_Nm = edge * sum_Nm;
  return command;
}

Result IdentifyMotor(const Recording& rows, const RigConstants& rig) {
  if (rows.size() < 200 || rows.back().time_s - rows.front().time_s < kShortest_s) {
    throw std::invalid_argument("motor: the recording is shorter than 8 s");
  }
  RequireUncoupled(rows);
  const Eigen::Vector2d published = Published(rows, rig);
  const identify::UniformRun even = identify::MakeUniform(RunOf(rows));
  TrialRows blocks;
  int block = -1;
  report::Series measured{.name = "Kt Iq"}, fitted{.name = "fit"};
  std::vector<Eigen::Vector4d> shown;
  for (const identify::UniformSegment& segment : even.segments) {
    const double rate_Hz = segment.rate_Hz();
    const identify::IirFilter filter =
        identify::ButterworthLowPass(4, std::min(kCutoff_Hz, 0.3 * rate_Hz), rate_Hz);
    const auto smooth = [&](const Eigen::VectorXd& signal) {
      return identify::FilterZeroPhase(filter, signal);
    };
    // A friction that switches with the velocity goes through the same filter as everything else.
    const Eigen::VectorXd raw_rad = segment.signals.at(types::Signal::kPosition);
    const Eigen::VectorXd angle_rad = smooth(raw_rad);
    const Eigen::VectorXd w = identify::WideDifference(angle_rad, segment.period_s);
    const Eigen::VectorXd dw = identify::WideDifference(w, segment.period_s);
    const Eigen::VectorXd sign = smooth(w.unaryExpr([](double v) { return v > 0.0 ? 1.0 : -1.0; }));
    const Eigen::VectorXd torque =
        rig.torque_constant_Nm_A * smooth(segment.signals.at(types::Signal::kMotorCurrent));
    const Eigen::VectorXd rate = identify::WideDifference(torque, segment.period_s);
    const auto border = static_cast<Eigen::Index>(kBorder_s * rate_Hz);
    double block_end_s = -1e9;
    for (Eigen::Index i = border; i + border < segment.size(); ++i) {
      if (segment.valid[static_cast<std::size_t>(i)] == 0) continue;
      const Eigen::Vector4d row(dw(i), w(i), sign(i), rate(i));
      if (segment.Time(i) - rows.front().time_s < 8.0) {
        measured.Add(segment.Time(i) - rows.front().time_s, torque(i));
        shown.push_back(row);
      }
      if (std::abs(w(i)) < kSlow_rad_s) continue;
      if (segment.Time(i) >= block_end_s) {
        block_end_s = segment.Time(i) + kBlock_s;
        ++block;
      }
      blocks.Add(block, row, torque(i));
    }
  }
  const TrialFit fit = blocks.Fit();
  fitted.x = measured.x;
  for (const Eigen::Vector4d& row : shown) fitted.y.push_back(fit.b.dot(row));

  Result result{.experiment = "motor", .title = "Motor inertia and damping (4.21)-(4.26)"};
  result.quantities = Quantities(fit, published);
  result.figures = {report::Chart(
      "Current and its fit", "Kt Iq, and J dw/dt + B w + Tc sign(w) with the fitted values.",
      "time, s", kFigure_px,
      {{"torque at the shaft, N m", {std::move(measured), std::move(fitted)}}})};
  return result;
}

}  // namespace sinew::experiment
