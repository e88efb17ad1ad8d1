#include "components/robot/residual/participant/component.h"

#include <sinew_idl/actuator.h>
#include <sinew_idl/joint.h>
#include <sinew_idl/residual.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "components/base/types/joints.h"
#include "components/base/types/run.h"
#include "components/robot/residual/file/residual_file.h"
#include "components/topics/node/tick_component.h"
#include "components/topics/node/tick_loop.h"

namespace sinew::residual {
namespace {

// Fields of JointSample that a model may read, with the signal that gives them.
constexpr std::pair<std::string_view, types::Signal> kFields[] = {
    {"pressure_bar", types::Signal::kChamberPressure},
    {"pressure_rate_bar_s", types::Signal::kChamberPressure},
    {"load_force_N", types::Signal::kLoadForce},
    {"payload_kg", types::Signal::kPayload},
    {"temperature_degC", types::Signal::kTemperature},
    {"valve_open", types::Signal::kValveOpen},
};

bool IsMeasured(std::uint32_t flags, types::Signal signal) {
  return (flags & types::SignalBit(signal)) != 0;
}

bool HasVoltageDrive(const actuator::JointModel& joint) { return joint.Find("drive_voltage") >= 0; }

// Messages to and from the residual monitors of all joints.
class RobotResidual {
 public:
  explicit RobotResidual(ResidualConfig config) : config_(std::move(config)) {}

  // A new session learns anew; ticks that never came are lost samples. A robot that does not
  // measure what the model reads, or has fewer joints, is not monitored: unfit.
  void Step(const node::Tick& tick, const msg::JointState& state,
            const node::TickInput<msg::ActuatorState>& actuator) {
    stale_ = !actuator.fresh();
    const bool begun = !monitors_.empty() && tick.session_id == session_id_;
    if (!begun) {
      if (stale_) return;  // actuator_state lists what is measured
      unfit_ = Unfit(state, actuator.value());
      if (!unfit_.empty()) {  // of the message: the next one may say otherwise
        monitors_.clear();
        output_ = {};
        return;
      }
      Begin(tick, actuator.value());
      if (!unfit_.empty()) return;
    }
    const auto seconds = [&](std::uint64_t at) {
      return static_cast<double>(at - first_tick_) * period_s_;
    };
    const bool hole = begun && tick.tick != last_tick_ + 1;
    time_s_ = seconds(tick.tick);
    last_tick_ = tick.tick;
    for (std::size_t j = 0; j < monitors_.size(); ++j) {
      if (hole) monitors_[j].Step(time_s_ - period_s_, {});
      JointReading reading;
      if (!stale_ && j < state.joint_count && j < actuator.value().joint_count) {
        const msg::ActuatorState& inside = actuator.value();
        const actuator::JointModel& joint = config_.robot.joints[j];
        reading.valid = state.valid[j] && inside.valid[j];
        reading.position_rad = state.position_rad[j];
        reading.motor_position_rad = has_motor_ ? inside.motor_position_rad[j]
                                                : joint.constants.gear_ratio * reading.position_rad;
        reading.drive_input =
            HasVoltageDrive(joint) ? inside.drive_voltage_V[j] : inside.motor_current_A[j];
        reading.pressure_bar = inside.chamber_pressure_bar[j];
        reading.load_force_N = inside.load_force_N[j];
        reading.payload_kg = inside.declared_payload_kg[j];
        reading.temperature_degC = inside.motor_temperature_degC[j];
        reading.valve_open = inside.valve_open[j];
      }
      output_[j] = monitors_[j].Step(time_s_, reading);
    }
  }
  msg::ResidualState ToMessage(const node::Tick& tick) const {
    msg::ResidualState message;
    message.state_tick = tick.tick;
    message.stale = stale_;
    message.joint_count = static_cast<std::uint8_t>(config_.robot.joints.size());
    for (std::size_t j = 0; j < config_.robot.joints.size(); ++j) {
      const MonitorOutput& out = output_[j];
      message.state[j] = monitors_.empty() ? State::kLost : out.state;
      message.learnt_share[j] = out.learnt;
      message.residual_Nm[j] = out.residual_Nm;
      message.rms_Nm[j] = out.rms_Nm;
      message.explained_share[j] = out.explained;
      message.change_rms_Nm[j] = out.change_rms_Nm;
      message.noise_Nm[j] = out.noise_Nm;
      message.statistic[j] = out.statistic;
      message.alarm[j] = out.alarm;
      message.since_ns[j] =
          out.alarm ? tick.stamp_ns - std::llround(1e9 * (time_s_ - out.since_s)) : 0;
      message.follows[j] = out.follows;
      message.rival[j] = out.rival;
      message.follows_share[j] = out.follows_share;
      message.change[j] = out.change;
      message.change_error[j] = out.change_error;
    }
    return message;
  }
  // The state in one line: a joint that learns, an alarm (and what it follows, which becomes more
  // certain every second). Empty: watching.
  std::string Line(bool with_cause) const {
    if (!unfit_.empty()) return unfit_;
    for (std::size_t j = 0; j < monitors_.size(); ++j) {
      const MonitorOutput& out = output_[j];
      if (!out.alarm) continue;
      std::string line =
          "joint '" + config_.robot.joints[j].name + "': what the model leaves changed";
      if (with_cause) {
        line += ", it follows " + std::string(NameOf(out.follows));
        if (out.rival != Cause::kNothing) line += " or " + std::string(NameOf(out.rival));
      }
      return line;
    }
    const auto learns = [](const MonitorOutput& out) { return out.learnt < 1.0; };
    const auto end = output_.begin() + static_cast<std::ptrdiff_t>(monitors_.size());
    if (monitors_.empty() || std::any_of(output_.begin(), end, learns)) {
      return "learning the residual of the model: changes cannot be detected yet";
    }
    return "";
  }
  bool unfit() const { return !unfit_.empty(); }

 private:
  // Why this robot cannot be monitored with the model; empty: it can.
  std::string Unfit(const msg::JointState& state, const msg::ActuatorState& actuator) const {
    const std::size_t joints = config_.robot.joints.size();
    if (state.joint_count < joints) {
      return "the model has " + std::to_string(joints) + " joints, the robot " +
             std::to_string(state.joint_count);
    }
    const std::uint32_t flags = actuator.measured_flags;
    for (const actuator::JointModel& joint : config_.robot.joints) {
      std::string missing;
      const auto need = [&](types::Signal signal, const std::string& reader) {
        if (IsMeasured(flags, signal) || !missing.empty()) return;
        missing = "joint '" + joint.name + "': the model's term '" + reader + "' reads '" +
                  std::string(types::SignalName(signal)) + "', which this robot does not measure";
      };
      for (const actuator::Term& term : joint.terms) {
        const effects::EffectInfo& info = term.effect->info();
        if (!joint.Counts(term)) continue;
        if (info.role == effects::Role::kDrive) {
          need(HasVoltageDrive(joint) ? types::Signal::kDriveVoltage : types::Signal::kMotorCurrent,
               info.name);
        }
        for (const std::string& field : info.needs) {
          for (const auto& [name, signal] : kFields) {
            if (field == name) need(signal, info.name);
          }
        }
      }
      if (!missing.empty()) return missing;
    }
    return "";
  }
  void Begin(const node::Tick& tick, const msg::ActuatorState& actuator) try {
    has_motor_ = IsMeasured(actuator.measured_flags, types::Signal::kMotorPosition);
    session_id_ = tick.session_id;
    first_tick_ = tick.tick;
    last_tick_ = tick.tick;
    period_s_ = tick.nominal_period_s;
    monitors_.clear();
    for (const actuator::JointModel& joint : config_.robot.joints) {
      monitors_.emplace_back(joint, config_.monitor, period_s_);
    }
    output_ = {};
  } catch (const std::invalid_argument& error) {  // of the period: it is the message's
    unfit_ = error.what();
    monitors_.clear();
    output_ = {};
  }

  ResidualConfig config_;
  std::vector<Monitor> monitors_;
  types::JointArray<MonitorOutput> output_{};
  std::uint64_t session_id_ = 0, first_tick_ = 0, last_tick_ = 0;
  double period_s_ = 0.0, time_s_ = 0.0;
  bool stale_ = false, has_motor_ = true;
  std::string unfit_;
};

class ResidualComponent final : public node::TickComponent {
 public:
  ResidualComponent(const node::Options& options, node::StopFlag& stop, ResidualConfig config)
      : TickComponent(options, stop), robot_(std::move(config)) {}

 private:
  void Compute(node::Tick& tick) override {
    robot_.Step(tick, state_.value(), actuator_);
    loop().Publish(output_, robot_.ToMessage(tick), tick);
    if (const std::string line = robot_.Line(true); line != reported_) {
      reported_ = line;
      node().SetState(robot_.unfit() ? node::Node::State::kFault : node::Node::State::kActive,
                      reported_);
    }
    if (const std::string line = robot_.Line(false); line != logged_) {
      logged_ = line;
      if (robot_.unfit()) {
        spdlog::error("{}", reported_);
      } else {
        spdlog::info("{}", reported_.empty() ? "watching" : reported_);
      }
    }
  }

  RobotResidual robot_;
  node::TickInput<msg::JointState>& state_ = loop().AddInput(node::kJointState);
  node::TickInput<msg::ActuatorState>& actuator_ = loop().AddInput(node::kActuatorState);
  node::Writer<msg::ResidualState> output_ = node().MakeWriter(node::kResidual);
  std::string reported_, logged_;
};

}  // namespace

std::unique_ptr<node::Component> MakeResidual(const node::Options& options, node::StopFlag& stop,
                                              const std::filesystem::path& model_path) {
  return std::make_unique<ResidualComponent>(options, stop,
                                             LoadResidual(options.config_path, model_path));
}

}  // namespace sinew::residual
