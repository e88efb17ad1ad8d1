// Faults of a joint: the latch that keeps the first one, and the table of rules that finds them in
// the joint's measurements.
//
// A fault is latched until the operator's reset, and only a fault that was reported is reset. The
// first fault is the cause; later ones change nothing. The rules of the table are assessed in
// order, in every cycle. Faults of events are raised where the event is: kEncoderJump and
// kOutputJump by JointMeasurement, kAnotherMaster by CanJoint, kNoClosedLoop and kZero by
// AxisStateMachine, kNotFinite and the compact exchange's kOutOfRange by CanPlant.
//
// Pure; one thread; allocates only when a fault begins or gets an error code.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "bridge/joints/encoder_watch.h"
#include "bridge/joints/joint_config.h"
#include "bridge/joints/joint_measurement.h"
#include "components/base/types/fault.h"

namespace sinew::bridge {

// Times the velocity limit: above it the joint has a fault.
inline constexpr double kOverspeed = 1.5;

// Parts of a controller that have an error register of their own.
enum class ErrorSource { kMotor, kEncoder, kController };

class FaultLatch {
 public:
  explicit FaultLatch(const JointConfig& joint);

  bool active() const { return fault_.active(); }
  const types::Fault& fault() const { return fault_; }  // without the joint's index
  types::FaultCause cause() const { return fault_.cause; }
  const std::string& text() const { return text_; }  // "joint 'knee' (node 3): ..."

  // Does nothing when a fault is latched.
  void Fail(types::FaultCause cause, std::string_view detail = {}) {
    Fail(types::Fault{.cause = cause}, detail);
  }
  void Fail(const types::Fault& fault, std::string_view detail = {});
  // To the detail of the fault that is latched.
  void Append(std::string_view more);
  // Appends a code that is not 0 to an axis error, at most one of each source.
  void AppendErrorCode(ErrorSource source, std::uint64_t code);
  // active(), and from now on the fault counts as reported.
  bool Report();
  // The operator's reset. True: the last Report was of a fault, and what is latched is cleared.
  bool ClearReported();

 private:
  std::string joint_;
  types::Fault fault_;
  std::string detail_;
  bool reported_ = false;
  std::uint32_t sources_ = 0;  // bit per ErrorSource whose code is in the text
  std::string text_;
};

struct FaultInput {
  const JointMeasurement& measured;
  const BridgeTiming& timing;
  const EncoderWatch& encoders;
  bool active = false;  // in closed-loop control, following commands
  std::int64_t now_ns = 0;
};

// A measured value beyond its limit, as in types::Fault.
struct Excess {
  double value = 0.0, limit = 0.0;
  std::string detail{};
};

struct FaultRule {
  types::FaultCause cause;
  std::optional<Excess> (*excess)(const FaultInput&);  // nothing: no fault
  bool silence = false;  // a state of the bus may be the reason: named in the text
};

// In the order in which they are assessed.
std::span<const FaultRule> FaultRules();

// The rule by which this joint has a fault from now on; nullptr: none, or there was a fault before.
const FaultRule* AssessFaults(const FaultInput& input, FaultLatch* fault);

// "0x41, invalid state, motor failed"
std::string AxisErrorText(std::uint32_t error);

}  // namespace sinew::bridge
