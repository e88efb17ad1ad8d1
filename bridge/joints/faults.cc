#include "bridge/joints/faults.h"

#include <array>
#include <cmath>
#include <cstdio>

namespace sinew::bridge {
namespace {

using types::FaultCause;

// Silence beyond its limit, in milliseconds.
std::optional<Excess> Silence(const FaultInput& in, std::int64_t stamp_ns, double limit_s) {
  const double silent_s = 1e-9 * static_cast<double>(in.now_ns - stamp_ns);
  if (in.now_ns - stamp_ns <= ToNs(limit_s)) return std::nullopt;
  return Excess{1e3 * silent_s, 1e3 * limit_s};
}

std::optional<Excess> Above(double value, double limit) {
  if (!(value > limit)) return std::nullopt;
  return Excess{value, limit};
}

constexpr const char* kUnexplained = ", by so much more than play and compliance allow";

std::optional<Excess> Still(double unexplained_rad, const char* detail) {
  if (!(unexplained_rad > 0.0)) return std::nullopt;
  return Excess{unexplained_rad, 0.0, std::string(detail) + kUnexplained};
}

std::optional<Excess> AxisError(const FaultInput& in) {
  const std::uint32_t error = in.measured.heartbeat.axis_error;
  if (error == 0) return std::nullopt;
  const auto value = static_cast<double>(error);
  return Excess{value, value, AxisErrorText(error)};
}

std::optional<Excess> NodeLost(const FaultInput& in) {
  if (!in.measured.config->output) return std::nullopt;
  const auto lost = Silence(in, in.measured.output_ns, in.timing.lost_after_s);
  return lost ? lost : Silence(in, in.measured.sensors_ns, in.timing.heartbeat_timeout_s);
}

std::optional<Excess> OutOfRange(const FaultInput& in) {
  const JointLimits& limits = in.measured.config->limits;
  const double position_rad = in.measured.position_rad();
  if (!in.active) return std::nullopt;
  if (position_rad > limits.upper_rad + limits.margin_rad) {
    return Excess{position_rad, limits.upper_rad + limits.margin_rad};
  }
  if (position_rad >= limits.lower_rad - limits.margin_rad) return std::nullopt;
  return Excess{position_rad, limits.lower_rad - limits.margin_rad};
}

std::optional<Excess> EncoderFrozen(const FaultInput& in) {
  if (!in.active) return std::nullopt;
  const auto output = Still(in.encoders.output_still_rad(),
                            "the output encoder stands still while the motor turns");
  return output ? output
                : Still(in.encoders.motor_still_rad(),
                        "the motor encoder stands still while the joint turns");
}

std::optional<Excess> Slip(const FaultInput& in, const char* detail) {
  if (!in.active || in.encoders.slip_s() <= kSlipPersists_s) return std::nullopt;
  return Excess{in.encoders.slip_rad(), 0.0, std::string(detail) + kUnexplained};
}

constexpr std::array kRules = {
    FaultRule{FaultCause::kAxisError, AxisError},
    FaultRule{FaultCause::kHeartbeatLost,
              [](const FaultInput& in) {
                return Silence(in, in.measured.heartbeat_ns, in.timing.heartbeat_timeout_s);
              },
              true},
    FaultRule{FaultCause::kEstimatesLost,
              [](const FaultInput& in) {
                return Silence(in, in.measured.estimates_ns, in.timing.lost_after_s);
              },
              true},
    FaultRule{FaultCause::kNodeLost, NodeLost, true},
    FaultRule{FaultCause::kOverTemperature,
              [](const FaultInput& in) {
                const JointConfig& c = *in.measured.config;
                return c.output ? Above(in.measured.sensors.motor_temperature_degC,
                                        c.limits.motor_temperature_degC)
                                : std::nullopt;
              }},
    FaultRule{FaultCause::kOverspeed,
              [](const FaultInput& in) {
                const JointConfig& c = *in.measured.config;
                return in.active
                           ? Above(std::abs(in.measured.motor_velocity_rad_s()) / c.gear_ratio,
                                   kOverspeed * c.limits.velocity_rad_s)
                           : std::nullopt;
              }},
    FaultRule{FaultCause::kOutOfRange, OutOfRange},
    // Limits: encoder_watch.h. A frozen encoder slips as well, so that it comes first.
    FaultRule{FaultCause::kEncoderFrozen, EncoderFrozen},
    FaultRule{FaultCause::kEncodersDisagree,
              [](const FaultInput& in) {
                return in.encoders.slip_grows()
                           ? Slip(in, "the output does not turn as fast as the motor")
                           : std::nullopt;
              }},
    FaultRule{FaultCause::kEncoderSlipped,
              [](const FaultInput& in) { return Slip(in, "an encoder or the gear slipped"); }},
};

}  // namespace

FaultLatch::FaultLatch(const JointConfig& joint)
    : joint_("joint '" + joint.name + "' (node " + std::to_string(joint.node) + "): ") {}

void FaultLatch::Fail(const types::Fault& fault, std::string_view detail) {
  if (active()) return;
  fault_ = fault;
  reported_ = false;
  detail_.clear();
  Append(detail);
}

void FaultLatch::Append(std::string_view more) {
  detail_ += more;
  text_ = joint_ + types::FaultText(fault_, detail_);
}

void FaultLatch::AppendErrorCode(ErrorSource source, std::uint64_t code) {
  static constexpr std::array kSources = {"motor", "encoder", "controller"};
  const auto index = static_cast<std::size_t>(source);
  const std::uint32_t bit = 1u << index;
  if (code == 0 || fault_.cause != FaultCause::kAxisError || (sources_ & bit) != 0) return;
  sources_ |= bit;
  char text[40];
  std::snprintf(text, sizeof text, ", %s 0x%llX", kSources[index],
                static_cast<unsigned long long>(code));
  Append(text);
}

bool FaultLatch::Report() {
  reported_ = active();
  return reported_;
}

bool FaultLatch::ClearReported() {
  sources_ = 0;
  if (!reported_) return false;
  fault_ = {};
  text_.clear();
  return true;
}

std::span<const FaultRule> FaultRules() { return kRules; }

const FaultRule* AssessFaults(const FaultInput& input, FaultLatch* fault) {
  if (fault->active()) return nullptr;
  for (const FaultRule& rule : kRules) {
    const std::optional<Excess> excess = rule.excess(input);
    if (!excess) continue;
    fault->Fail({.cause = rule.cause, .value = excess->value, .limit = excess->limit},
                excess->detail);
    return &rule;
  }
  return nullptr;
}

std::string AxisErrorText(std::uint32_t error) {
  static constexpr struct {
    std::uint32_t bit;
    const char* name;
  } kNames[] = {
      {can::axis_error::kInvalidState, "invalid state"},
      {can::axis_error::kMotorFailed, "motor failed"},
      {can::axis_error::kEncoderFailed, "encoder failed"},
      {can::axis_error::kControllerFailed, "controller failed"},
      {can::axis_error::kWatchdogTimerExpired, "watchdog expired"},
      {can::axis_error::kMinEndstopPressed, "minimum end stop"},
      {can::axis_error::kMaxEndstopPressed, "maximum end stop"},
      {can::axis_error::kEstopRequested, "estop requested"},
      {can::axis_error::kOverTemp, "over-temperature"},
      {can::axis_error::kUnknownPosition, "unknown position"},
  };
  char text[32];
  std::snprintf(text, sizeof text, "0x%X", error);
  std::string result = text;
  for (const auto& [bit, name] : kNames) {
    if ((error & bit) != 0) result += std::string(", ") + name;
  }
  return result;
}

}  // namespace sinew::bridge
