#include "components/learn/esn/dataset/dataset.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "components/base/types/require.h"
#include "components/model/identify/differentiate.h"
#include "components/model/identify/iir_filter.h"
#include "components/model/identify/uniform.h"

namespace sinew::esn {
namespace {

using identify::UniformSegment;
using Measured = types::Signal;

constexpr int kFilterOrder = 4;
// The smoothing filter must leave something of the band below half the rate.
constexpr double kLargestCutoffShare = 0.45;
// Two periods that differ by less need no new grid.
constexpr double kSamePeriod = 1e-6;

void CheckConfig(const DatasetConfig& config) {
  using types::Require;
  if (config.inputs.empty()) throw std::invalid_argument("inputs: none, expected at least one");
  Require(config.period_s > 0.0, "period_s", config.period_s, "above 0");
  Require(config.smoothing_Hz > 0.0, "smoothing_Hz", config.smoothing_Hz, "above 0");
  Require(config.play_margin_rad >= 0.0, "play_margin_rad", config.play_margin_rad, "at least 0");
  Require(config.region_guard_s >= 0.0, "region_guard_s", config.region_guard_s, "at least 0");
  Require(config.blocks >= 1, "blocks", config.blocks, "at least 1");
  Require(config.train_share > 0.0 && config.train_share <= 1.0, "train_share", config.train_share,
          "above 0, at most 1");
}

bool NeedsPlay(const DatasetConfig& config) {
  return config.region != Region::kAll || std::find(config.inputs.begin(), config.inputs.end(),
                                                    Signal::kPlayAngle) != config.inputs.end();
}

// The signal that must have been measured for an input.
Measured SourceOf(Signal input) {
  switch (input) {
    case Signal::kMotorVelocity:
    case Signal::kPlayAngle:
      return Measured::kMotorPosition;
    case Signal::kChamberPressure:
      return Measured::kChamberPressure;
    case Signal::kLoadForce:
      return Measured::kLoadForce;
    case Signal::kPayload:
      return Measured::kPayload;
    case Signal::kTemperature:
      return Measured::kTemperature;
    default:
      return Measured::kPosition;
  }
}

const Eigen::VectorXd& Need(const UniformSegment& segment, Measured signal, const std::string& run,
                            std::string_view what) {
  const auto found = segment.signals.find(signal);
  if (found == segment.signals.end()) {
    throw std::invalid_argument(run + ": no signal '" + std::string(types::SignalName(signal)) +
                                "', which " + std::string(what) + " needs");
  }
  return found->second;
}

// Motion of an axis on the recording's own grid, without phase.
struct Motion {
  Eigen::VectorXd position;
  Eigen::VectorXd velocity;
  Eigen::VectorXd acceleration;
};

Motion Differentiate(const Eigen::VectorXd& measured, double period_s, double smoothing_Hz) {
  const double rate_Hz = 1.0 / period_s;
  const identify::IirFilter filter = identify::ButterworthLowPass(
      kFilterOrder, std::min(smoothing_Hz, kLargestCutoffShare * rate_Hz), rate_Hz);
  Motion motion;
  motion.position = identify::FilterZeroPhase(filter, measured);
  motion.velocity = identify::WideDifference(motion.position, period_s);
  motion.acceleration = identify::WideDifference(motion.velocity, period_s);
  return motion;
}

bool HasDrive(const actuator::JointModel& model, Measured* input) {
  for (const actuator::Term& term : model.terms) {
    const effects::EffectInfo& info = term.effect->info();
    if (info.role != effects::Role::kDrive || !model.Counts(term)) continue;
    *input = info.name == "drive_voltage" ? Measured::kDriveVoltage : Measured::kMotorCurrent;
    return true;
  }
  return false;
}

Eigen::VectorXd DriveTorque(const UniformSegment& segment, const actuator::JointModel& model,
                            const std::string& run) {
  Measured input = Measured::kMotorCurrent;
  if (!HasDrive(model, &input)) {
    throw std::invalid_argument("model " + model.name +
                                ": no drive term, which the target drive_torque_Nm needs");
  }
  const Eigen::VectorXd& drive = Need(segment, input, run, "the target drive_torque_Nm");
  std::vector<double> memory(static_cast<std::size_t>(model.memory_size()));
  Eigen::VectorXd torque(drive.size());
  for (Eigen::Index t = 0; t < drive.size(); ++t) {
    effects::JointSample sample;
    sample.drive_input = drive(t);
    torque(t) = model.Torque(effects::Role::kDrive, sample, memory);
  }
  return torque;
}

// Midway between the 1 % and the 99 % quantile.
double MiddleOf(std::vector<double> values) {
  const auto quantile = [&](double q) {
    const auto at =
        values.begin() + static_cast<std::ptrdiff_t>(q * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), at, values.end());
    return *at;
  };
  const double low = quantile(0.01);
  return 0.5 * (low + quantile(0.99));
}

struct Columns {
  std::vector<Eigen::VectorXd> inputs;
  Eigen::VectorXd target;
  Eigen::VectorXd
      play;  // motor / N - output, without the centre; empty where there is no motor angle
};

Columns ColumnsOf(const UniformSegment& segment, const actuator::JointModel& model,
                  const DatasetConfig& config, const std::string& run) {
  Columns columns;
  const Eigen::VectorXd& position = Need(segment, Measured::kPosition, run, "every network");
  Motion output = Differentiate(position, segment.period_s, config.smoothing_Hz);
  if (config.derivatives_from_motor) {
    const Eigen::VectorXd motor =
        Need(segment, Measured::kMotorPosition, run, "derivatives_from: motor") /
        model.constants.gear_ratio;
    const Motion geared = Differentiate(motor, segment.period_s, config.smoothing_Hz);
    output.velocity = geared.velocity;
    output.acceleration = geared.acceleration;
  }
  if (segment.signals.contains(Measured::kMotorPosition)) {
    columns.play =
        segment.signals.at(Measured::kMotorPosition) / model.constants.gear_ratio - position;
  }
  for (const Signal input : config.inputs) {
    const Eigen::VectorXd& source =
        Need(segment, SourceOf(input), run, "input " + std::string(SignalName(input)));
    switch (input) {
      case Signal::kReferencePosition:
      case Signal::kPosition:
        columns.inputs.push_back(output.position);
        break;
      case Signal::kReferenceVelocity:
      case Signal::kVelocity:
        columns.inputs.push_back(output.velocity);
        break;
      case Signal::kReferenceAcceleration:
        columns.inputs.push_back(output.acceleration);
        break;
      case Signal::kReferenceDirection:
        columns.inputs.push_back(output.velocity.unaryExpr(&ReferenceDirection));
        break;
      case Signal::kMotorVelocity:
        columns.inputs.push_back(
            Differentiate(source, segment.period_s, config.smoothing_Hz).velocity);
        break;
      case Signal::kPlayAngle:
        columns.inputs.push_back(columns.play);
        break;
      default:
        columns.inputs.push_back(source);
    }
  }
  columns.target =
      config.target == Target::kDriveTorque
          ? DriveTorque(segment, model, run)
          : Eigen::VectorXd(Need(segment, Measured::kLoadForce, run, "the target load_torque_Nm") *
                            model.constants.link_length_m);
  return columns;
}

// The columns at the network's period; valid where both neighbours were.
void Resample(const UniformSegment& segment, double period_s, Columns* columns,
              std::vector<char>* valid) {
  *valid = segment.valid;
  if (std::abs(segment.period_s - period_s) < kSamePeriod * period_s) return;
  const Eigen::Index size = segment.size();
  const double length_s = segment.period_s * static_cast<double>(size - 1);
  const Eigen::Index count = static_cast<Eigen::Index>(length_s / period_s) + 1;
  const Eigen::VectorXd from = Eigen::VectorXd::LinSpaced(size, 0.0, length_s);
  const Eigen::VectorXd to =
      Eigen::VectorXd::LinSpaced(count, 0.0, period_s * static_cast<double>(count - 1));
  const auto onto = [&](Eigen::VectorXd& column) {
    if (column.size() != 0) column = identify::SplineAt(from, column, to);
  };
  for (Eigen::VectorXd& column : columns->inputs) onto(column);
  onto(columns->target);
  onto(columns->play);
  valid->assign(static_cast<std::size_t>(count), 0);
  for (Eigen::Index t = 0; t < count; ++t) {
    const Eigen::Index before =
        std::min(static_cast<Eigen::Index>(to(t) / segment.period_s), size - 1);
    const Eigen::Index after = std::min(before + 1, size - 1);
    (*valid)[static_cast<std::size_t>(t)] = segment.valid[static_cast<std::size_t>(before)] != 0 &&
                                            segment.valid[static_cast<std::size_t>(after)] != 0;
  }
}

// Samples at most `guard` away from a sample of the other region.
template <class InsideFunction>
std::vector<char> NearABorder(Eigen::Index count, const InsideFunction& inside,
                              Eigen::Index guard) {
  std::vector<char> near_border(static_cast<std::size_t>(count), 0);
  for (Eigen::Index t = 1; t < count && guard > 0; ++t) {
    if (inside(t) == inside(t - 1)) continue;
    const Eigen::Index first = std::max<Eigen::Index>(0, t - guard);
    const Eigen::Index last = std::min(count, t + guard);
    for (Eigen::Index i = first; i < last; ++i) near_border[static_cast<std::size_t>(i)] = 1;
  }
  return near_border;
}

}  // namespace

std::string_view TargetName(Target target) {
  return target == Target::kDriveTorque ? "drive_torque_Nm" : "load_torque_Nm";
}

std::vector<Input> InputsOfJoint(const std::vector<Signal>& signals, int joint) {
  std::vector<Input> inputs;
  inputs.reserve(signals.size());
  for (const Signal signal : signals) inputs.push_back({signal, joint});
  return inputs;
}

std::vector<Input> InputsOfRobot(const std::vector<Signal>& signals, int count) {
  std::vector<Input> inputs;
  for (int joint = 0; joint < count; ++joint) {
    for (const Input& input : InputsOfJoint(signals, joint)) inputs.push_back(input);
  }
  return inputs;
}

Dataset MakeRobotDataset(const std::vector<std::vector<types::Run>>& runs_of_joint,
                         const std::vector<actuator::JointModel>& models,
                         const DatasetConfig& config, bool test_only) {
  if (models.empty() || runs_of_joint.size() != models.size()) {
    throw std::invalid_argument("training: recordings of " + std::to_string(runs_of_joint.size()) +
                                " joints, expected those of the model's " +
                                std::to_string(models.size()));
  }
  if (NeedsPlay(config)) {
    throw std::invalid_argument(
        "training: a network of all joints has region 'all' and no input play_angle_rad, since "
        "each "
        "joint has a play of its own");
  }
  Dataset robot = MakeDataset(runs_of_joint[0], models[0], config, test_only);
  for (std::size_t j = 1; j < models.size(); ++j) {
    const Dataset joint = MakeDataset(runs_of_joint[j], models[j], config, test_only);
    bool same = joint.sequences.size() == robot.sequences.size();
    for (std::size_t s = 0; same && s < joint.sequences.size(); ++s) {
      same = joint.sequences[s].use.size() == robot.sequences[s].use.size();
    }
    if (!same) {
      throw std::invalid_argument("training: the recordings of joint '" + models[j].name +
                                  "' have other lengths than those of '" + models[0].name +
                                  "', expected every joint in every tick");
    }
    for (std::size_t s = 0; s < joint.sequences.size(); ++s) {
      const Sequence& from = joint.sequences[s];
      Sequence& to = robot.sequences[s];
      to.inputs.conservativeResize(Eigen::NoChange, to.inputs.cols() + from.inputs.cols());
      to.inputs.rightCols(from.inputs.cols()) = from.inputs;
      to.targets.conservativeResize(Eigen::NoChange, to.targets.cols() + from.targets.cols());
      to.targets.rightCols(from.targets.cols()) = from.targets;
      for (std::size_t t = 0; t < from.use.size(); ++t) {
        if (from.use[t] == Use::kNone) to.use[t] = Use::kNone;
      }
    }
    robot.inside += joint.inside;
  }
  return robot;
}

Dataset MakeDataset(const std::vector<types::Run>& runs, const actuator::JointModel& model,
                    const DatasetConfig& config, bool test_only) {
  CheckConfig(config);
  if (runs.empty()) throw std::invalid_argument("training: no recording");
  const bool needs_play = NeedsPlay(config);
  if (needs_play && !(model.backlash_rad > 0.0)) {
    throw std::invalid_argument(
        "model " + model.name +
        ": backlash_rad is 0, but the region of the network is defined by the backlash");
  }

  Dataset data;
  std::vector<Columns> pieces;
  std::vector<std::vector<char>> valid;
  std::vector<double> play;
  for (const types::Run& run : runs) {
    for (const UniformSegment& segment : identify::MakeUniform(run).segments) {
      Columns columns = ColumnsOf(segment, model, config, run.name);
      if (needs_play && columns.play.size() == 0) {
        throw std::invalid_argument(
            run.name + ": no signal 'motor_position', which the play angle is computed from");
      }
      std::vector<char> good;
      Resample(segment, config.period_s, &columns, &good);
      play.insert(play.end(), columns.play.begin(), columns.play.end());
      pieces.push_back(std::move(columns));
      valid.push_back(std::move(good));
    }
  }
  if (pieces.empty())
    throw std::invalid_argument("training: the recordings hold no unbroken piece of 2 s");
  if (needs_play)
    data.play_centre_rad = config.play_centre_rad ? *config.play_centre_rad : MiddleOf(play);

  const auto guard =
      static_cast<Eigen::Index>(std::lround(config.region_guard_s / config.period_s));
  const double half_rad = 0.5 * model.backlash_rad - config.play_margin_rad;
  for (std::size_t p = 0; p < pieces.size(); ++p) {
    const Columns& columns = pieces[p];
    const Eigen::Index count = columns.target.size();
    Sequence sequence;
    sequence.inputs.resize(count, static_cast<Eigen::Index>(columns.inputs.size()));
    for (std::size_t i = 0; i < columns.inputs.size(); ++i) {
      sequence.inputs.col(static_cast<Eigen::Index>(i)) = columns.inputs[i];
      if (config.inputs[i] == Signal::kPlayAngle) {  // from the lower contact
        sequence.inputs.col(static_cast<Eigen::Index>(i)).array() +=
            0.5 * model.backlash_rad - data.play_centre_rad;
      }
    }
    sequence.targets = columns.target;
    sequence.use.assign(static_cast<std::size_t>(count), Use::kNone);
    const auto is_inside = [&](Eigen::Index t) {
      return needs_play && std::abs(columns.play(t) - data.play_centre_rad) < half_rad;
    };
    const std::vector<char> guarded = NearABorder(count, is_inside, guard);
    for (Eigen::Index t = 0; t < count; ++t) {
      if (!valid[p][static_cast<std::size_t>(t)]) continue;
      ++data.samples;
      const bool inside = is_inside(t);
      if (inside) ++data.inside;
      if (config.region == Region::kInside && !inside) continue;
      if (config.region == Region::kOutside && inside) continue;
      if (config.region != Region::kAll && guarded[static_cast<std::size_t>(t)]) continue;
      // Position within its block, 0 .. 1.
      const double block = static_cast<double>(t) * config.blocks / static_cast<double>(count);
      const bool train = !test_only && block - std::floor(block) < config.train_share;
      sequence.use[static_cast<std::size_t>(t)] = train ? Use::kTrain : Use::kTest;
    }
    data.duration_s += static_cast<double>(count) * config.period_s;
    data.sequences.push_back(std::move(sequence));
  }
  return data;
}

}  // namespace sinew::esn
