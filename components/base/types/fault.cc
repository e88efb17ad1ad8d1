#include "components/base/types/fault.h"

#include <array>

#include "components/base/types/text.h"

namespace sinew::types {
namespace {

constexpr std::string_view kOtherRobot = "the controller is configured for another robot";
constexpr std::string_view kPowerAndBus =
    "is its power on, is its bus up and not overloaded ('sinew doctor')?";
constexpr std::string_view kLookAtEncoders =
    "look at encoder, coupling and gear before the next arming";

constexpr std::array<FaultTerms, kFaultCauses> kTerms = {{
    {FaultCause::kNone, "none", "", 0, ""},
    {FaultCause::kCommandMissing, "joint_command missing", "ms", 1,
     "is the controller alive ('sinew list'), is this host fit for real time ('sinew doctor')?",
     " for "},
    {FaultCause::kCycleLate, "this provider's cycle began late", "ms", 1,
     "see 'sinew doctor' for what keeps a process from its times"},
    {FaultCause::kCommandNotFinite, "joint_command is not a finite number", "", 0,
     "the controller's log says why"},
    {FaultCause::kCommandJoints, "joint_command names", "joints", 0, kOtherRobot, " ",
     ", expected "},
    {FaultCause::kCommandNames, "another name in the controller's configuration", "", 0,
     "it is configured for another robot, or its joints stand in another order"},
    {FaultCause::kFall, "fall", "", 0, "stand it up or hang it, then reset"},
    {FaultCause::kPlant, "the plant failed", "", 0, "its log says more"},
    {FaultCause::kAxisError, "axis error", "", 0,
     "when its cause is gone, 'sinew reset' clears it"},
    {FaultCause::kHeartbeatLost, "no heartbeat", "ms", 1, kPowerAndBus, " for "},
    {FaultCause::kEstimatesLost, "no encoder estimates", "ms", 1, kPowerAndBus, " for "},
    {FaultCause::kNodeLost, "nothing from the sensor node", "ms", 1, kPowerAndBus, " for "},
    {FaultCause::kEncoderJump, "motor encoder jump", "rev", 2, kLookAtEncoders},
    {FaultCause::kOverTemperature, "motor too hot", "degC", 1, "let it cool down"},
    {FaultCause::kOverspeed, "too fast", "rad/s", 2, "look for what drove it"},
    {FaultCause::kOutOfRange, "out of range", "rad", 3, "move it back by hand"},
    {FaultCause::kNoClosedLoop, "no closed-loop control", "ms", 1,
     "see the drive's errors and its calibration"},
    {FaultCause::kZero, "zero check", "rad", 3, "check the zero of both encoders"},
    {FaultCause::kNotFinite, "a command that is not finite", "", 0,
     "the controller's log says why"},
    {FaultCause::kOutputJump, "output encoder jump", "rad", 3, kLookAtEncoders},
    {FaultCause::kEncoderFrozen, "encoder frozen", "rad", 3, kLookAtEncoders},
    {FaultCause::kEncoderSlipped, "encoder slipped", "rad", 3, kLookAtEncoders},
    {FaultCause::kEncodersDisagree, "encoders disagree", "rad", 3, kLookAtEncoders},
    {FaultCause::kAnotherMaster, "another master commands it on this bus", "", 0,
     "end that one, then reset"},
}};

std::string Number(double value, const FaultTerms& terms) {
  std::string out = Text("%.*f", terms.decimals, value);
  if (terms.decimals > 0) out.erase(out.find_last_not_of('0') + 1);
  if (out.ends_with('.')) out.pop_back();
  return out + " " + std::string(terms.unit);
}

}  // namespace

msg::Fault ToMessage(const Fault& fault) noexcept {
  return {.cause = fault.cause,
          .joint = static_cast<std::uint8_t>(fault.joint),
          .value = fault.value,
          .limit = fault.limit};
}

Fault FromMessage(const msg::Fault& message) noexcept {
  return {.cause = message.cause,
          .joint = message.joint,
          .value = message.value,
          .limit = message.limit};
}

const FaultTerms& TermsOf(FaultCause cause) { return kTerms[static_cast<std::size_t>(cause)]; }

std::string FaultText(const Fault& fault, std::string_view detail) {
  if (!fault.active()) return {};
  const FaultTerms& terms = TermsOf(fault.cause);
  std::string text;
  if (fault.joint != kWholeRobot) text = "joint " + std::to_string(fault.joint) + ": ";
  text += terms.name;
  const bool measured = fault.value != fault.limit;
  if (measured) {
    text += std::string(terms.before) + Number(fault.value, terms);
    text += std::string(terms.between) + Number(fault.limit, terms);
  }
  if (!detail.empty()) text += (measured ? ", " : ": ") + std::string(detail);
  return text + ": " + std::string(terms.remedy);
}

}  // namespace sinew::types
