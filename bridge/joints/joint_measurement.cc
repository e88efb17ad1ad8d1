#include "bridge/joints/joint_measurement.h"

#include <algorithm>
#include <cmath>

#include "bridge/joints/faults.h"
#include "components/base/types/angle.h"

namespace sinew::bridge {
namespace {

using can::Command;
using types::FaultCause;

constexpr double kJump_rev = 0.25;
constexpr double kQueued_s = 0.01;  // longest wait of a measurement for its place on the bus

}  // namespace

double JointMeasurement::motor_position_rad() const {
  return config->direction * types::kTwoPi * (estimates.position_rev - config->zero_rev - home_rev);
}

double JointMeasurement::motor_velocity_rad_s() const {
  return config->direction * types::kTwoPi * estimates.velocity_rev_s;
}

double JointMeasurement::position_rad() const {
  if (!config->output) return motor_position_at_output_rad();
  return config->output->direction * (output.angle_rad - config->output->zero_rad);
}

double JointMeasurement::velocity_rad_s() const {
  if (!config->output) return motor_velocity_rad_s() / config->gear_ratio;
  return config->output->direction * output.velocity_rad_s;
}

double JointMeasurement::Revolutions(double output_rad) const {
  return config->direction * output_rad * config->gear_ratio / types::kTwoPi + config->zero_rev +
         home_rev;
}

std::int64_t JointMeasurement::motion_ns() const {
  return config->output ? std::min(estimates_ns, output_ns) : estimates_ns;
}

std::int64_t JointMeasurement::oldest_ns() const {
  const std::int64_t slow_ns = config->output ? std::min(iq_ns, sensors_ns) : iq_ns;
  return std::min(motion_ns(), slow_ns);
}

std::string JointMeasurement::Missing() const {
  const std::string axis = "axis node " + std::to_string(config->node);
  if (heartbeat_ns == 0) return "no heartbeat of " + axis;
  if (estimates_ns == 0) return "no encoder estimates of " + axis;
  if (config->output && (output_ns == 0 || sensors_ns == 0)) {
    return "nothing from sensor node " + std::to_string(config->output->node);
  }
  return {};
}

void JointMeasurement::ClearErrors(std::int64_t until_ns) {
  heartbeat.axis_error = 0;
  errors_cleared_ns = until_ns;
}

Taken JointMeasurement::TakeFromAxis(const can::Received& received, FaultLatch* fault) {
  const can::Frame& frame = received.frame;
  const can::Firmware firmware = config->firmware;
  switch (can::AddressOf(frame)->command) {
    case Command::kHeartbeat:
      if (const auto m = can::Decode<can::Heartbeat>(frame, firmware)) {
        heartbeat = *m;
        heartbeat_ns = received.stamp_ns;
        // Sent before the controller took our Clear_Errors: its errors are those just cleared.
        heartbeat.axis_error = received.stamp_ns <= errors_cleared_ns ? 0 : can::ErrorsOf(*m);
        return Taken::kStored;
      }
      break;
    case Command::kGetEncoderEstimates:
      if (const auto m = can::Decode<can::EncoderEstimates>(frame, firmware);
          m && std::isfinite(m->position_rev) && std::isfinite(m->velocity_rev_s)) {
        TakeEstimates(*m, received.stamp_ns, fault);
        return Taken::kEstimates;
      }
      break;
    case Command::kGetIq:
      if (const auto m = can::Decode<can::Iq>(frame, firmware); m && std::isfinite(m->measured_A)) {
        iq_A = m->measured_A;
        iq_ns = received.stamp_ns;
        return Taken::kIq;
      }
      break;
    case Command::kGetMotorError:
      if (const auto m = can::Decode<can::MotorError>(frame, firmware)) {
        fault->AppendErrorCode(ErrorSource::kMotor, m->error);
        return Taken::kStored;
      }
      break;
    case Command::kGetEncoderError:
      if (const auto m = can::Decode<can::EncoderError>(frame, firmware)) {
        fault->AppendErrorCode(ErrorSource::kEncoder, m->error);
        return Taken::kStored;
      }
      break;
    case Command::kGetControllerError:
      if (const auto m = can::Decode<can::ControllerError>(frame, firmware)) {
        fault->AppendErrorCode(ErrorSource::kController, m->error);
        return Taken::kStored;
      }
      break;
    default:
      return Taken::kUnused;
  }
  return Taken::kMalformed;
}

void JointMeasurement::TakeEstimates(const can::EncoderEstimates& news, std::int64_t stamp_ns,
                                     FaultLatch* fault) {
  if (estimates_ns != 0) {
    const double dt_s =
        1e-9 * static_cast<double>(std::max<std::int64_t>(stamp_ns - estimates_ns, 0));
    const double fastest_rev_s =
        kOverspeed * config->limits.velocity_rad_s * config->gear_ratio / types::kTwoPi;
    const double step_rev = std::abs(news.position_rev - estimates.position_rev);
    // The stamp is the frame's; the measurement may have waited for the bus.
    const double expected_rev = std::abs(estimates.velocity_rev_s) * (dt_s + kQueued_s);
    const double largest_rev = std::max(fastest_rev_s * dt_s, expected_rev) + kJump_rev;
    if (step_rev > largest_rev) {
      fault->Fail({.cause = FaultCause::kEncoderJump, .value = step_rev, .limit = largest_rev});
    }
  }
  estimates = news;
  estimates_ns = stamp_ns;
}

void JointMeasurement::AssessOutputStep(const can::OutputEncoder& before, std::int64_t stamp_ns,
                                        FaultLatch* fault) const {
  const double dt_s =
      1e-9 * static_cast<double>(std::max<std::int64_t>(stamp_ns - output_ns, 0)) + kQueued_s;
  const double play_rad = config->zero_check ? config->zero_check->play_rad : 0.0;
  const double fastest_rad_s =
      std::max(kOverspeed * config->limits.velocity_rad_s, std::abs(before.velocity_rad_s));
  const double step_rad = std::abs(output.angle_rad - before.angle_rad);
  const double largest_rad = fastest_rad_s * dt_s + play_rad + kOutputJump_rad;
  if (step_rad <= largest_rad) return;
  fault->Fail({.cause = FaultCause::kOutputJump, .value = step_rad, .limit = largest_rad});
}

Taken JointMeasurement::TakeFromNode(const can::Received& received, FaultLatch* fault) {
  switch (static_cast<can::NodeCommand>(can::AddressOf(received.frame)->command)) {
    case can::NodeCommand::kOutputEncoder:
      if (const auto m = can::DecodeOutputEncoder(received.frame)) {
        // A sequence number that stands still is an old measurement in a new frame.
        const bool fresh = output_ns == 0 || m->sequence != output.sequence;
        const can::OutputEncoder before = output;
        output = *m;
        if (!m->encoder_valid && output_ns != 0) {  // take the relays' state, keep the angle
          output.angle_rad = before.angle_rad;
          output.velocity_rad_s = before.velocity_rad_s;
        }
        if (fresh && m->encoder_valid) {
          if (output_ns != 0) AssessOutputStep(before, received.stamp_ns, fault);
          output_ns = received.stamp_ns;
        }
        return Taken::kStored;
      }
      break;
    case can::NodeCommand::kJointSensors:
      if (const auto m = can::DecodeJointSensors(received.frame)) {
        sensors = *m;
        sensors_ns = received.stamp_ns;
        return Taken::kStored;
      }
      break;
    default:
      return Taken::kUnused;
  }
  return Taken::kMalformed;
}

}  // namespace sinew::bridge
