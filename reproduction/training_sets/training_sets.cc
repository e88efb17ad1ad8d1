#include "reproduction/training_sets/training_sets.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "components/model/identify/statistics.h"
#include "components/record/recording/csv_map.h"
#include "sim/surrogate/excitation.h"
#include "sim/surrogate/parameters.h"
#include "sim/surrogate/random.h"

namespace sinew::reproduction {
namespace {

using networks::Task;

constexpr std::uint64_t kStreamLevels = 410;
constexpr double kSea_s = 110.0;
constexpr double kPea_s = 350.0;
// 0.5 to 2.7 Nm at the output: with the chamber's 1.4 Nm the link comes back at the higher levels
// by itself, and slowly or when the hand lets it at the lower ones.
constexpr double kLowest_Nm = 0.006;
constexpr double kHighest_Nm = 0.035;

// A level that moves from one random value to the next, every 0.7 to 1.9 s.
class TorqueLevel {
 public:
  TorqueLevel(std::uint64_t seed, double duration_s) {
    surrogate::RandomStream random(seed, kStreamLevels);
    for (double t = 0.0; t < duration_s + 4.0; t += random.Uniform(0.7, 1.9)) {
      time_s_.push_back(t);
      level_Nm_.push_back(random.Uniform(kLowest_Nm, kHighest_Nm));
    }
  }

  double At(double time_s) const {
    const auto after = std::upper_bound(time_s_.begin(), time_s_.end(), time_s);
    if (after == time_s_.begin()) return level_Nm_.front();
    if (after == time_s_.end()) return level_Nm_.back();
    const std::size_t k = static_cast<std::size_t>(after - time_s_.begin());
    const double x = (time_s - time_s_[k - 1]) / (time_s_[k] - time_s_[k - 1]);
    return level_Nm_[k - 1] + (level_Nm_[k] - level_Nm_[k - 1]) * x * x * (3.0 - 2.0 * x);
  }

 private:
  std::vector<double> time_s_;
  std::vector<double> level_Nm_;
};

}  // namespace

types::Run RunOf(const std::vector<surrogate::LogRow>& rows, const std::string& name) {
  using types::Signal;
  types::Run run;
  run.name = name;
  const Eigen::Index count = static_cast<Eigen::Index>(rows.size());
  run.time_s.resize(count);
  const auto fill = [&](Signal signal, auto member) {
    Eigen::VectorXd& column = run.signals[signal];
    column.resize(count);
    for (Eigen::Index t = 0; t < count; ++t) {
      column(t) = static_cast<double>(rows[static_cast<std::size_t>(t)].*member);
    }
  };
  for (Eigen::Index t = 0; t < count; ++t) {
    run.time_s(t) = rows[static_cast<std::size_t>(t)].time_s;
  }
  using surrogate::LogRow;
  fill(Signal::kPosition, &LogRow::output_angle_rad);
  fill(Signal::kVelocity, &LogRow::output_velocity_rad_s);
  fill(Signal::kMotorPosition, &LogRow::motor_angle_rad);
  fill(Signal::kMotorVelocity, &LogRow::motor_velocity_rad_s);
  fill(Signal::kMotorCurrent, &LogRow::motor_current_A);
  fill(Signal::kChamberPressure, &LogRow::chamber_pressure_bar);
  fill(Signal::kLoadForce, &LogRow::load_force_N);
  run.content_hash = recording::ContentHash(run);
  return run;
}

types::Run MakeSurrogateRun(const SetOptions& options) {
  if (options.task == Task::kForce) {
    throw std::invalid_argument("set: the surrogate makes sea and pea, not force");
  }
  const bool sea = options.task == Task::kSea;
  const double duration_s = options.duration_s > 0.0 ? options.duration_s : sea ? kSea_s : kPea_s;
  surrogate::RigParameters rig;
  rig.spread = options.spread;
  rig.seed = options.specimen_seed != 0 ? options.specimen_seed : options.seed;
  rig = surrogate::Specimen(rig);
  rig.seed = options.seed;
  const surrogate::Excitation excitation(
      {.kind = sea ? surrogate::ExcitationKind::kSea : surrogate::ExcitationKind::kPea,
       .duration_s = duration_s,
       .seed = options.seed});
  excitation.Prepare(&rig);
  const TorqueLevel level(options.seed, duration_s);
  const auto command = [&](double time_s, const provider::PlantSensors& sensors,
                           provider::PlantCommand* to, provider::Disturbance* disturbance) {
    excitation(time_s, sensors, to, disturbance);
    if (!sea && !options.constant_torque) to->motor_torque_Nm[0] = level.At(time_s);
  };
  const std::vector<surrogate::LogRow> rows =
      surrogate::RunExperiment(rig, {.duration_s = duration_s, .seed = options.seed}, command);
  return RunOf(rows, std::string(sea ? "sea" : "pea") + " " + std::to_string(options.seed));
}

double NoiseFloor(Task task) {
  const surrogate::SensorParameters sensors;
  const networks::TableConfig table;
  const double deviation = task == Task::kSea
                               ? sensors.load_cell_noise_N * table.link_length_m
                               : sensors.current_noise_A * table.torque_constant_Nm_A;
  return deviation * deviation;
}

double NoiseFromDifferences(const Eigen::VectorXd& signal) {
  std::vector<double> d3;
  for (Eigen::Index t = 3; t < signal.size(); ++t) {
    d3.push_back(std::abs(signal(t) - 3.0 * signal(t - 1) + 3.0 * signal(t - 2) - signal(t - 3)));
  }
  if (d3.empty()) return 0.0;
  // The median of |x| is 0.6745 standard deviations of a normal x.
  const double deviation = identify::Quantile(d3, 0.5) / 0.6745;
  return deviation * deviation / 20.0;
}

}  // namespace sinew::reproduction
