#include "reproduction/control_test/trial.h"

#include <cmath>
#include <cstdio>
#include <stdexcept>

namespace sinew::control_test {
namespace {

constexpr double kSaturatedFrom = 0.98;  // of the current limit: the sensor is noisy
constexpr Eigen::Index kPictureEvery = 4;

// Rows from <= time < to, counted from the first row.
types::Run Window(const types::Run& run, double from_s, double to_s) {
  Eigen::Index first = 0;
  while (first < run.size() && run.time_s[first] - run.time_s[0] < from_s) ++first;
  Eigen::Index end = first;
  while (end < run.size() && run.time_s[end] - run.time_s[0] < to_s) ++end;
  // Half a cycle at 240 Hz may be missing at the end, not more.
  if (run.size() == 0 || run.time_s[end - (end > 0)] - run.time_s[0] < to_s - 0.1) {
    throw std::invalid_argument(run.name + " ends before " + std::to_string(to_s) + " s");
  }
  types::Run window = run;
  window.time_s = run.time_s.segment(first, end - first);
  for (auto& [signal, values] : window.signals) {
    values = Eigen::VectorXd(values.segment(first, end - first));
  }
  return window;
}

}  // namespace

const char* ArmName(Arm arm) {
  switch (arm) {
    case Arm::kPid:
      return "pid";
    case Arm::kLinear:
      return "linear";
    case Arm::kNetwork:
      return "network";
    case Arm::kAdapted:
      return "adapted";
    case Arm::kInverse:
      return "inverse";
  }
  return "unknown";
}

const char* ArmTitle(Arm arm) {
  switch (arm) {
    case Arm::kPid:
      return "PID";
    case Arm::kLinear:
      return "PID + linear compensator (7.1)";
    case Arm::kNetwork:
      return "PID + networks by regime";
    case Arm::kAdapted:
      return "PID + networks, adapted by RLS";
    case Arm::kInverse:
      return "PID + true inverse (bound)";
  }
  return "unknown";
}

const char* LoadTitle(Load load) {
  switch (load) {
    case Load::kNone:
      return "none";
    case Load::kExternal:
      return "0.5 kg throughout";
    case Load::kChanging:
      return "0.5 kg put on after 3 cycles";
  }
  return "unknown";
}

std::string Trial::name() const {
  char text[80];
  const char* load_name = load == Load::kNone       ? "free"
                          : load == Load::kExternal ? "load"
                                                    : "change";
  std::snprintf(text, sizeof text, "%s-%gbar-%s-%dcycles-seed%llu", ArmName(arm), pressure_bar,
                load_name, cycles, static_cast<unsigned long long>(seed));
  return text;
}

std::vector<Trial> BenchmarkTrials(const std::vector<std::uint64_t>& seeds) {
  std::vector<Trial> trials;
  for (const Arm arm : {Arm::kPid, Arm::kLinear, Arm::kNetwork, Arm::kInverse}) {
    for (const std::uint64_t seed : seeds) trials.push_back({arm, 4.0, Load::kNone, 4, seed});
  }
  return trials;
}

std::vector<Trial> GridTrials(const std::vector<double>& pressures_bar,
                              const std::vector<Load>& loads, const std::vector<Arm>& arms,
                              std::uint64_t seed) {
  std::vector<Trial> trials;
  for (const double pressure_bar : pressures_bar) {
    for (const Load load : loads) {
      for (const Arm arm : arms) trials.push_back({arm, pressure_bar, load, 8, seed});
    }
  }
  return trials;
}

TrialScore ScoreTrial(const Trial& trial, const types::Run& run, const MotorFacts& motor) {
  const types::Run whole = Window(run, kStart_s, trial.end_s());
  TrialScore score;
  score.whole = tools::ScoreTracking(whole);
  score.from_rest_mse_rad2 =
      tools::ScoreTracking(Window(run, kSoftStart_s, trial.end_s())).mean_square_error_rad2;
  score.late_mse_rad2 =
      tools::ScoreTracking(Window(run, trial.end_s() - kLateCycles / kFrequency_Hz, trial.end_s()))
          .mean_square_error_rad2;
  const Eigen::ArrayXd current_A = whole.At(types::Signal::kMotorCurrent).array();
  const auto count = static_cast<double>(whole.size());
  score.saturated_share =
      static_cast<double>((current_A.abs() >= kSaturatedFrom * motor.current_limit_A).count()) /
      count;
  score.motor_torque_rms_Nm = motor.torque_constant_Nm_A * score.whole.rms_current_A;
  const Eigen::ArrayXd power_W =
      motor.torque_constant_Nm_A * current_A * whole.At(types::Signal::kMotorVelocity).array();
  score.positive_work_J = power_W.max(0.0).mean() * score.whole.duration_s;
  for (Eigen::Index i = 0; i < whole.size(); i += kPictureEvery) {
    score.time_s.push_back(whole.time_s[i] - whole.time_s[0]);
    score.reference_rad.push_back(whole.At(types::Signal::kReferencePosition)[i]);
    score.position_rad.push_back(whole.At(types::Signal::kPosition)[i]);
  }
  return score;
}

}  // namespace sinew::control_test
