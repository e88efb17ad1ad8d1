#include "bridge/joints/faults.h"

#include <array>
#include <cmath>
#include <cstdio>

namespace sinew::bridge {
namespace {

bool IsOlder(const FaultInput& in, std::int64_t stamp_ns, double limit_s) {
  return in.now_ns - stamp_ns > ToNs(limit_s);
}

std::string Beyond(const char* what, double beyond_rad) {
  char text[128];
  std::snprintf(text, sizeof text, "%s, %.3f rad more than play and compliance allow", what,
                beyond_rad);
  return text;
}

constexpr std::array kRules = {
    FaultRule{FaultKind::kAxisError,
              [](const FaultInput& in) { return in.measured.heartbeat.axis_error != 0; },
              [](const FaultInput& in) { return AxisErrorText(in.measured.heartbeat.axis_error); }},
    FaultRule{FaultKind::kHeartbeatLost,
              [](const FaultInput& in) {
                return IsOlder(in, in.measured.heartbeat_ns, in.timing.heartbeat_timeout_s);
              },
              [](const FaultInput&) { return std::string("no heartbeat"); }, true},
    FaultRule{FaultKind::kEstimatesLost,
              [](const FaultInput& in) {
                return IsOlder(in, in.measured.estimates_ns, in.timing.lost_after_s);
              },
              [](const FaultInput&) { return std::string("no encoder estimates"); }, true},
    FaultRule{FaultKind::kNodeLost,
              [](const FaultInput& in) {
                return in.measured.config->output &&
                       (IsOlder(in, in.measured.output_ns, in.timing.lost_after_s) ||
                        IsOlder(in, in.measured.sensors_ns, in.timing.heartbeat_timeout_s));
              },
              [](const FaultInput&) { return std::string("nothing from the sensor node"); }, true},
    FaultRule{FaultKind::kOverTemperature,
              [](const FaultInput& in) {
                const JointConfig& c = *in.measured.config;
                return c.output &&
                       in.measured.sensors.motor_temperature_degC > c.limits.motor_temperature_degC;
              },
              [](const FaultInput&) { return std::string("motor too hot"); }},
    FaultRule{FaultKind::kOverspeed,
              [](const FaultInput& in) {
                const JointConfig& c = *in.measured.config;
                return in.active && std::abs(in.measured.motor_velocity_rad_s()) >
                                        kOverspeed * c.limits.velocity_rad_s * c.gear_ratio;
              },
              [](const FaultInput&) { return std::string("too fast"); }},
    FaultRule{FaultKind::kOutOfRange,
              [](const FaultInput& in) {
                const JointLimits& limits = in.measured.config->limits;
                const double position_rad = in.measured.position_rad();
                return in.active && (position_rad > limits.upper_rad + limits.margin_rad ||
                                     position_rad < limits.lower_rad - limits.margin_rad);
              },
              [](const FaultInput& in) {
                char text[64];
                std::snprintf(text, sizeof text, "at %.3f rad, outside its limits",
                              in.measured.position_rad());
                return std::string(text);
              }},
    // Limits: encoder_watch.h. A frozen encoder slips as well, so that it comes first.
    FaultRule{FaultKind::kEncoderFrozen,
              [](const FaultInput& in) {
                return in.active && (in.encoders.output_still_rad() > 0.0 ||
                                     in.encoders.motor_still_rad() > 0.0);
              },
              [](const FaultInput& in) {
                return in.encoders.output_still_rad() > 0.0
                           ? Beyond("the output encoder stands still while the motor turns",
                                    in.encoders.output_still_rad())
                           : Beyond("the motor encoder stands still while the joint turns",
                                    in.encoders.motor_still_rad());
              }},
    FaultRule{FaultKind::kEncodersDisagree,
              [](const FaultInput& in) {
                return in.active && in.encoders.slip_s() > kSlipPersists_s &&
                       in.encoders.slip_grows();
              },
              [](const FaultInput& in) {
                return Beyond("the output does not turn as fast as the motor: the encoders differ",
                              in.encoders.slip_rad());
              }},
    FaultRule{
        FaultKind::kEncoderSlipped,
        [](const FaultInput& in) { return in.active && in.encoders.slip_s() > kSlipPersists_s; },
        [](const FaultInput& in) {
          return Beyond("an encoder or the gear slipped: the encoders differ",
                        in.encoders.slip_rad());
        }},
};

}  // namespace

const char* FaultName(FaultKind kind) {
  static constexpr std::array<const char*, kFaultKinds> kNames = {"none",
                                                                  "axis error",
                                                                  "heartbeat lost",
                                                                  "estimates lost",
                                                                  "node lost",
                                                                  "encoder jump",
                                                                  "too hot",
                                                                  "overspeed",
                                                                  "out of range",
                                                                  "no closed loop",
                                                                  "zero check",
                                                                  "not finite",
                                                                  "output encoder jump",
                                                                  "encoder frozen",
                                                                  "encoder slipped",
                                                                  "encoders disagree",
                                                                  "another master"};
  return kNames[static_cast<std::size_t>(kind)];
}

FaultLatch::FaultLatch(const JointConfig& joint)
    : joint_("joint '" + joint.name + "' (node " + std::to_string(joint.node) + "): ") {}

void FaultLatch::Fail(FaultKind kind, std::string_view what) {
  if (active()) return;
  kind_ = kind;
  reported_ = false;
  text_ = joint_;
  text_ += what;
}

void FaultLatch::AppendErrorCode(ErrorSource source, std::uint64_t code) {
  static constexpr std::array kSources = {"motor", "encoder", "controller"};
  const auto index = static_cast<std::size_t>(source);
  const std::uint32_t bit = 1u << index;
  if (code == 0 || kind_ != FaultKind::kAxisError || (sources_ & bit) != 0) return;
  sources_ |= bit;
  char text[40];
  std::snprintf(text, sizeof text, ", %s 0x%llX", kSources[index],
                static_cast<unsigned long long>(code));
  text_ += text;
}

bool FaultLatch::Report() {
  reported_ = active();
  return reported_;
}

bool FaultLatch::ClearReported() {
  sources_ = 0;
  if (!reported_) return false;
  kind_ = FaultKind::kNone;
  text_.clear();
  return true;
}

std::span<const FaultRule> FaultRules() { return kRules; }

const FaultRule* AssessFaults(const FaultInput& input, FaultLatch* fault) {
  if (fault->active()) return nullptr;
  for (const FaultRule& rule : kRules) {
    if (!rule.holds(input)) continue;
    fault->Fail(rule.kind, rule.text(input));
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
  std::snprintf(text, sizeof text, "axis error 0x%X", error);
  std::string result = text;
  for (const auto& [bit, name] : kNames) {
    if ((error & bit) != 0) result += std::string(", ") + name;
  }
  return result;
}

}  // namespace sinew::bridge
