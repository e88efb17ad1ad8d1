#include "reproduction/networks/dataset/dataset.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "components/model/identify/differentiate.h"
#include "components/model/identify/iir_filter.h"
#include "components/model/identify/statistics.h"
#include "components/model/identify/uniform.h"

namespace sinew::networks {
namespace {

using identify::UniformSegment;
using types::Signal;

constexpr int kFilterOrder = 4;
constexpr double kLargestCutoffShare = 0.45;  // of the rate
constexpr double kPush_N = 1.0;

const Eigen::VectorXd& Need(const UniformSegment& segment, Signal signal, const std::string& run) {
  const auto found = segment.signals.find(signal);
  if (found == segment.signals.end()) {
    throw std::invalid_argument(run + ": no signal '" + std::string(types::SignalName(signal)) +
                                "', which the task needs");
  }
  return found->second;
}

Eigen::VectorXd Smooth(const Eigen::VectorXd& x, const UniformSegment& segment, double cutoff_Hz) {
  const double rate_Hz = segment.rate_Hz();
  return identify::FilterZeroPhase(
      identify::ButterworthLowPass(kFilterOrder, std::min(cutoff_Hz, kLargestCutoffShare * rate_Hz),
                                   rate_Hz),
      x);
}

// The measured velocity, or the position's.
Eigen::VectorXd Velocity(const UniformSegment& segment, Signal velocity, Signal position,
                         const TableConfig& config, const std::string& run) {
  const auto found = segment.signals.find(velocity);
  if (found != segment.signals.end()) return found->second;
  return identify::WideDifference(
      Smooth(Need(segment, position, run), segment, config.smoothing_Hz), segment.period_s);
}

struct Columns {
  std::vector<Eigen::VectorXd> inputs;
  Eigen::VectorXd target;
  Eigen::Index begin = 0;
  Eigen::Index end = 0;
};

Columns Sea(const UniformSegment& s, const TableConfig& config, const std::string& run) {
  Columns c;
  const Eigen::VectorXd play =
      Need(s, Signal::kMotorPosition, run) / config.gear_ratio - Need(s, Signal::kPosition, run);
  c.inputs = {
      play,
      Velocity(s, Signal::kMotorVelocity, Signal::kMotorPosition, config, run) / config.gear_ratio -
          Velocity(s, Signal::kVelocity, Signal::kPosition, config, run),
      Need(s, Signal::kChamberPressure, run)};
  const Eigen::VectorXd& force = Need(s, Signal::kLoadForce, run);
  c.target = force * config.link_length_m;
  c.end = s.size();
  if (config.whole_sea_set) return c;
  while (c.begin < c.end && force(c.begin) < kPush_N) ++c.begin;
  // The hand pushes the link down, which raises the play angle; the chamber brings it back.
  const std::vector<double> values(play.begin(), play.end());
  const double middle = 0.5 * (identify::Quantile(values, 0.02) + identify::Quantile(values, 0.98));
  while (c.end > c.begin && play(c.end - 1) > middle) --c.end;
  return c;
}

Columns Pea(const UniformSegment& s, const TableConfig& config, const std::string& run) {
  Columns c;
  const Eigen::VectorXd motor =
      Smooth(Need(s, Signal::kMotorPosition, run) / config.gear_ratio, s, config.smoothing_Hz);
  c.inputs = {Need(s, Signal::kPosition, run),
              Velocity(s, Signal::kVelocity, Signal::kPosition, config, run),
              Need(s, Signal::kChamberPressure, run),
              Need(s, Signal::kLoadForce, run),
              identify::WideDifference(identify::WideDifference(motor, s.period_s), s.period_s),
              Velocity(s, Signal::kMotorVelocity, Signal::kMotorPosition, config, run)};
  c.target = Need(s, Signal::kMotorCurrent, run) * config.torque_constant_Nm_A;
  c.end = s.size();
  return c;
}

Columns Force(const UniformSegment& s, const TableConfig& config, const std::string& run) {
  Columns c;
  const Eigen::VectorXd& position = Need(s, Signal::kPosition, run);
  c.inputs = {position, Velocity(s, Signal::kVelocity, Signal::kPosition, config, run),
              Need(s, Signal::kChamberPressure, run)};
  c.target = Need(s, Signal::kLoadForce, run);
  c.end = s.size();
  return c;
}

// Onto the network's period; valid where both neighbours were.
void Resample(const UniformSegment& segment, double period_s, Columns* c,
              std::vector<char>* valid) {
  constexpr double kSamePeriod = 1e-3;
  *valid = segment.valid;
  if (std::abs(segment.period_s - period_s) < kSamePeriod * period_s) return;
  const Eigen::Index size = segment.size();
  const double length_s = segment.period_s * static_cast<double>(size - 1);
  const Eigen::Index count = static_cast<Eigen::Index>(length_s / period_s) + 1;
  const Eigen::VectorXd from = Eigen::VectorXd::LinSpaced(size, 0.0, length_s);
  const Eigen::VectorXd to =
      Eigen::VectorXd::LinSpaced(count, 0.0, period_s * static_cast<double>(count - 1));
  for (Eigen::VectorXd& column : c->inputs) column = identify::SplineAt(from, column, to);
  c->target = identify::SplineAt(from, c->target, to);
  const double ratio = period_s / segment.period_s;
  valid->assign(static_cast<std::size_t>(count), 0);
  for (Eigen::Index t = 0; t < count; ++t) {
    const auto before = static_cast<std::size_t>(static_cast<double>(t) * ratio);
    const std::size_t after = std::min(before + 1, segment.valid.size() - 1);
    (*valid)[static_cast<std::size_t>(t)] = segment.valid[before] != 0 && segment.valid[after] != 0;
  }
  c->begin = static_cast<Eigen::Index>(std::ceil(static_cast<double>(c->begin) / ratio));
  c->end = std::min(count, static_cast<Eigen::Index>(static_cast<double>(c->end) / ratio));
}

}  // namespace

const TaskInfo& InfoOf(Task task) {
  static const std::array<TaskInfo, 3> kInfos = {
      TaskInfo{"sea",
               {"play_angle_rad", "play_velocity_rad_s", "chamber_pressure_bar"},
               "load_torque_Nm",
               "Nm",
               {0, 1, 2}},
      TaskInfo{"pea",
               {"position_rad", "velocity_rad_s", "chamber_pressure_bar", "load_force_N",
                "acceleration_rad_s2", "motor_velocity_rad_s"},
               "motor_torque_Nm",
               "Nm",
               {4, 1, 3}},
      TaskInfo{"force",
               {"position_m", "velocity_m_s", "chamber_pressure_bar"},
               "load_force_N",
               "N",
               {0, 1, 2}}};
  return kInfos[static_cast<std::size_t>(task)];
}

std::vector<esn::Sequence> MakeTable(const std::vector<types::Run>& runs,
                                     const TableConfig& config) {
  if (!(config.period_s > 0.0) || !(config.smoothing_Hz > 0.0) || config.blocks < 1 ||
      !(config.train_share > 0.0 && config.train_share <= 1.0) || !(config.gear_ratio > 0.0)) {
    throw std::invalid_argument(
        "table: expected period_s, smoothing_Hz, gear_ratio above 0, blocks at least 1, "
        "train_share in (0, 1]");
  }
  if (runs.empty()) throw std::invalid_argument("table: no recording");
  std::vector<esn::Sequence> sequences;
  for (const types::Run& run : runs) {
    for (const UniformSegment& segment : identify::MakeUniform(run).segments) {
      Columns c = config.task == Task::kSea   ? Sea(segment, config, run.name)
                  : config.task == Task::kPea ? Pea(segment, config, run.name)
                                              : Force(segment, config, run.name);
      std::vector<char> valid;
      Resample(segment, config.period_s, &c, &valid);
      const Eigen::Index count = c.end - c.begin;
      if (count < config.blocks) continue;
      esn::Sequence q;
      q.inputs.resize(count, static_cast<Eigen::Index>(c.inputs.size()));
      for (std::size_t i = 0; i < c.inputs.size(); ++i) {
        q.inputs.col(static_cast<Eigen::Index>(i)) = c.inputs[i].segment(c.begin, count);
      }
      q.targets = c.target.segment(c.begin, count);
      q.use.assign(static_cast<std::size_t>(count), esn::Use::kNone);
      const double taught = config.train_share * static_cast<double>(count) - 1e-6;
      for (Eigen::Index t = 0; t < count; ++t) {
        if (valid[static_cast<std::size_t>(c.begin + t)] == 0) continue;
        const Eigen::Index place = t * config.blocks % count;  // in its block, of count
        q.use[static_cast<std::size_t>(t)] =
            static_cast<double>(place) < taught ? esn::Use::kTrain : esn::Use::kTest;
      }
      sequences.push_back(std::move(q));
    }
  }
  if (sequences.empty()) {
    throw std::invalid_argument("table: the recordings hold nothing of the task '" +
                                std::string(InfoOf(config.task).name) + "'");
  }
  return sequences;
}

}  // namespace sinew::networks
