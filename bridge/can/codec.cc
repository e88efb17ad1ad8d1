#include "bridge/can/codec.h"

#include "bridge/can/bytes.h"

namespace sinew::can {
namespace {

constexpr int kDbcLength = 8;

// Per message: command, bytes its signals take, bytes to fields and back.
template <class Message>
struct Layout;

#define SINEW_CAN_LAYOUT(Message, command_, needed_)                          \
  template <>                                                                 \
  struct Layout<Message> {                                                    \
    static constexpr Command kCommand = Command::command_;                    \
    static constexpr int kNeeded = needed_;                                   \
    static void Put(const Message& message, Firmware firmware, Frame& frame); \
    static void Get(const Frame& frame, Firmware firmware, Message& message); \
  }

SINEW_CAN_LAYOUT(Heartbeat, kHeartbeat, 8);
SINEW_CAN_LAYOUT(Estop, kEstop, 0);
SINEW_CAN_LAYOUT(MotorError, kGetMotorError, 4);
SINEW_CAN_LAYOUT(EncoderError, kGetEncoderError, 4);
SINEW_CAN_LAYOUT(SensorlessError, kGetSensorlessError, 4);
SINEW_CAN_LAYOUT(SetAxisNodeId, kSetAxisNodeId, 4);
SINEW_CAN_LAYOUT(SetAxisState, kSetAxisState, 4);
SINEW_CAN_LAYOUT(EncoderEstimates, kGetEncoderEstimates, 8);
SINEW_CAN_LAYOUT(EncoderCount, kGetEncoderCount, 8);
SINEW_CAN_LAYOUT(SetControllerMode, kSetControllerMode, 8);
SINEW_CAN_LAYOUT(SetInputPos, kSetInputPos, 8);
SINEW_CAN_LAYOUT(SetInputVel, kSetInputVel, 8);
SINEW_CAN_LAYOUT(SetInputTorque, kSetInputTorque, 4);
SINEW_CAN_LAYOUT(SetLimits, kSetLimits, 4);
SINEW_CAN_LAYOUT(StartAnticogging, kStartAnticogging, 0);
SINEW_CAN_LAYOUT(SetTrajVelLimit, kSetTrajVelLimit, 4);
SINEW_CAN_LAYOUT(SetTrajAccelLimits, kSetTrajAccelLimits, 8);
SINEW_CAN_LAYOUT(SetTrajInertia, kSetTrajInertia, 4);
SINEW_CAN_LAYOUT(Iq, kGetIq, 8);
SINEW_CAN_LAYOUT(SensorlessEstimates, kGetSensorlessEstimates, 8);
SINEW_CAN_LAYOUT(Reboot, kReboot, 0);
SINEW_CAN_LAYOUT(BusVoltageCurrent, kGetBusVoltageCurrent, 4);
SINEW_CAN_LAYOUT(ClearErrors, kClearErrors, 0);
SINEW_CAN_LAYOUT(SetLinearCount, kSetLinearCount, 4);
SINEW_CAN_LAYOUT(SetPosGain, kSetPosGain, 4);
SINEW_CAN_LAYOUT(SetVelGains, kSetVelGains, 8);
SINEW_CAN_LAYOUT(AdcVoltage, kGetAdcVoltage, 4);
SINEW_CAN_LAYOUT(AdcRequest, kGetAdcVoltage, 1);
SINEW_CAN_LAYOUT(ControllerError, kGetControllerError, 4);
#undef SINEW_CAN_LAYOUT

// Bytes this firmware needs, where it differs from the table.
template <class Message>
constexpr int Needed(Firmware) {
  return Layout<Message>::kNeeded;
}
template <>
constexpr int Needed<SetLimits>(Firmware firmware) {
  return firmware == Firmware::k0_5_1 ? 4 : 8;
}
template <>
constexpr int Needed<BusVoltageCurrent>(Firmware firmware) {
  return firmware == Firmware::k0_5_6 ? 8 : 4;
}
template <>
constexpr int Needed<MotorError>(Firmware firmware) {
  return firmware == Firmware::k0_5_6 ? 8 : 4;
}

void Layout<Heartbeat>::Put(const Heartbeat& m, Firmware firmware, Frame& frame) {
  PutInteger(frame, 0, m.axis_error);
  if (firmware == Firmware::k0_5_1) {
    PutInteger(frame, 4, static_cast<std::uint32_t>(m.axis_state));
    return;
  }
  frame.data[4] = static_cast<std::uint8_t>(m.axis_state);
  frame.data[7] = m.trajectory_done ? 0x80 : 0x00;
  if (firmware == Firmware::k0_5_4) return;
  frame.data[5] = m.motor_error ? 1 : 0;
  frame.data[6] = m.encoder_error ? 1 : 0;
  frame.data[7] = static_cast<std::uint8_t>(frame.data[7] | (m.controller_error ? 1 : 0));
}
void Layout<Heartbeat>::Get(const Frame& frame, Firmware firmware, Heartbeat& m) {
  m.axis_error = GetInteger<std::uint32_t>(frame, 0);
  m.axis_state = static_cast<AxisState>(frame.data[4]);
  if (firmware == Firmware::k0_5_1) return;
  m.trajectory_done = (frame.data[7] & 0x80) != 0;
  if (firmware == Firmware::k0_5_4) return;
  m.motor_error = (frame.data[5] & 1) != 0;
  m.encoder_error = (frame.data[6] & 1) != 0;
  m.controller_error = (frame.data[7] & 1) != 0;
}

void Layout<MotorError>::Put(const MotorError& m, Firmware firmware, Frame& frame) {
  PutInteger(frame, 0, firmware == Firmware::k0_5_6 ? m.error : m.error & 0xFFFFFFFFU);
}
void Layout<MotorError>::Get(const Frame& frame, Firmware firmware, MotorError& m) {
  m.error = firmware == Firmware::k0_5_6 ? GetInteger<std::uint64_t>(frame, 0)
                                         : GetInteger<std::uint32_t>(frame, 0);
}

void Layout<SetLimits>::Put(const SetLimits& m, Firmware firmware, Frame& frame) {
  PutFloat(frame, 0, m.velocity_limit_rev_s);
  if (firmware != Firmware::k0_5_1) PutFloat(frame, 4, m.current_limit_A);
}
void Layout<SetLimits>::Get(const Frame& frame, Firmware firmware, SetLimits& m) {
  m.velocity_limit_rev_s = GetFloat(frame, 0);
  if (firmware != Firmware::k0_5_1) m.current_limit_A = GetFloat(frame, 4);
}

void Layout<BusVoltageCurrent>::Put(const BusVoltageCurrent& m, Firmware firmware, Frame& frame) {
  PutFloat(frame, 0, m.voltage_V);
  if (firmware == Firmware::k0_5_6) PutFloat(frame, 4, m.current_A);
}
void Layout<BusVoltageCurrent>::Get(const Frame& frame, Firmware firmware, BusVoltageCurrent& m) {
  m.voltage_V = GetFloat(frame, 0);
  if (firmware == Firmware::k0_5_6) m.current_A = GetFloat(frame, 4);
}

void Layout<SetAxisState>::Put(const SetAxisState& m, Firmware, Frame& frame) {
  PutInteger(frame, 0, static_cast<std::uint32_t>(m.state));
}
void Layout<SetAxisState>::Get(const Frame& frame, Firmware firmware, SetAxisState& m) {
  // Firmware before 0.5.6 reads 16 bits. A state beyond a byte is no state: undefined.
  const std::uint32_t state = firmware == Firmware::k0_5_6 ? GetInteger<std::uint32_t>(frame, 0)
                                                           : GetInteger<std::uint16_t>(frame, 0);
  m.state = state > 0xFF ? AxisState::kUndefined : static_cast<AxisState>(state);
}

void Layout<SetControllerMode>::Put(const SetControllerMode& m, Firmware, Frame& frame) {
  PutInteger(frame, 0, static_cast<std::int32_t>(m.control_mode));
  PutInteger(frame, 4, static_cast<std::int32_t>(m.input_mode));
}
void Layout<SetControllerMode>::Get(const Frame& frame, Firmware, SetControllerMode& m) {
  m.control_mode = static_cast<ControlMode>(GetInteger<std::int32_t>(frame, 0));
  m.input_mode = static_cast<InputMode>(GetInteger<std::int32_t>(frame, 4));
}

constexpr double kFeedForwardStep = 0.001;  // rev/s and Nm; firmware 0.5.x, 0.4 had 0.1 and 0.01
void Layout<SetInputPos>::Put(const SetInputPos& m, Firmware, Frame& frame) {
  PutFloat(frame, 0, m.position_rev);
  PutInteger(frame, 4, Quantise<std::int16_t>(m.velocity_feed_forward_rev_s, kFeedForwardStep));
  PutInteger(frame, 6, Quantise<std::int16_t>(m.torque_feed_forward_Nm, kFeedForwardStep));
}
void Layout<SetInputPos>::Get(const Frame& frame, Firmware, SetInputPos& m) {
  m.position_rev = GetFloat(frame, 0);
  m.velocity_feed_forward_rev_s = kFeedForwardStep * GetInteger<std::int16_t>(frame, 4);
  m.torque_feed_forward_Nm = kFeedForwardStep * GetInteger<std::int16_t>(frame, 6);
}

void Layout<AdcRequest>::Put(const AdcRequest& m, Firmware, Frame& frame) {
  frame.data[0] = m.gpio;
}
void Layout<AdcRequest>::Get(const Frame& frame, Firmware, AdcRequest& m) {
  m.gpio = frame.data[0];
}

// Messages without signals.
#define SINEW_CAN_EMPTY(Message)                                 \
  void Layout<Message>::Put(const Message&, Firmware, Frame&) {} \
  void Layout<Message>::Get(const Frame&, Firmware, Message&) {}
SINEW_CAN_EMPTY(Estop)
SINEW_CAN_EMPTY(StartAnticogging)
SINEW_CAN_EMPTY(Reboot)
SINEW_CAN_EMPTY(ClearErrors)
#undef SINEW_CAN_EMPTY

// One 32-bit integer at the start.
#define SINEW_CAN_INTEGER(Message, field)                               \
  void Layout<Message>::Put(const Message& m, Firmware, Frame& frame) { \
    PutInteger(frame, 0, m.field);                                      \
  }                                                                     \
  void Layout<Message>::Get(const Frame& frame, Firmware, Message& m) { \
    m.field = GetInteger<decltype(m.field)>(frame, 0);                  \
  }
SINEW_CAN_INTEGER(EncoderError, error)
SINEW_CAN_INTEGER(SensorlessError, error)
SINEW_CAN_INTEGER(ControllerError, error)
SINEW_CAN_INTEGER(SetAxisNodeId, node)
SINEW_CAN_INTEGER(SetLinearCount, position_counts)
#undef SINEW_CAN_INTEGER

void Layout<EncoderCount>::Put(const EncoderCount& m, Firmware, Frame& frame) {
  PutInteger(frame, 0, m.shadow_count);
  PutInteger(frame, 4, m.count_in_cpr);
}
void Layout<EncoderCount>::Get(const Frame& frame, Firmware, EncoderCount& m) {
  m.shadow_count = GetInteger<std::int32_t>(frame, 0);
  m.count_in_cpr = GetInteger<std::int32_t>(frame, 4);
}

// One float, or two.
#define SINEW_CAN_FLOAT(Message, field)                                 \
  void Layout<Message>::Put(const Message& m, Firmware, Frame& frame) { \
    PutFloat(frame, 0, m.field);                                        \
  }                                                                     \
  void Layout<Message>::Get(const Frame& frame, Firmware, Message& m) { \
    m.field = GetFloat(frame, 0);                                       \
  }
#define SINEW_CAN_FLOATS(Message, first, second)                        \
  void Layout<Message>::Put(const Message& m, Firmware, Frame& frame) { \
    PutFloat(frame, 0, m.first);                                        \
    PutFloat(frame, 4, m.second);                                       \
  }                                                                     \
  void Layout<Message>::Get(const Frame& frame, Firmware, Message& m) { \
    m.first = GetFloat(frame, 0);                                       \
    m.second = GetFloat(frame, 4);                                      \
  }
SINEW_CAN_FLOATS(EncoderEstimates, position_rev, velocity_rev_s)
SINEW_CAN_FLOATS(SensorlessEstimates, position_rev, velocity_rev_s)
SINEW_CAN_FLOATS(SetInputVel, velocity_rev_s, torque_feed_forward_Nm)
SINEW_CAN_FLOATS(SetTrajAccelLimits, acceleration_limit_rev_s2, deceleration_limit_rev_s2)
SINEW_CAN_FLOATS(Iq, setpoint_A, measured_A)
SINEW_CAN_FLOATS(SetVelGains, gain_Nm_s_rev, integrator_gain_Nm_rev)
SINEW_CAN_FLOAT(SetInputTorque, torque_Nm)
SINEW_CAN_FLOAT(SetTrajVelLimit, velocity_limit_rev_s)
SINEW_CAN_FLOAT(SetTrajInertia, inertia_Nm_s2_rev)
SINEW_CAN_FLOAT(SetPosGain, gain_rev_s_rev)
SINEW_CAN_FLOAT(AdcVoltage, voltage_V)
#undef SINEW_CAN_FLOAT
#undef SINEW_CAN_FLOATS

bool IsGet(Command command) {
  switch (command) {
    case Command::kGetMotorError:
    case Command::kGetEncoderError:
    case Command::kGetSensorlessError:
    case Command::kGetEncoderEstimates:
    case Command::kGetEncoderCount:
    case Command::kGetIq:
    case Command::kGetSensorlessEstimates:
    case Command::kGetBusVoltageCurrent:
    case Command::kGetControllerError:
      return true;
    default:
      return false;
  }
}

}  // namespace

std::optional<Address> AddressOf(const Frame& frame) noexcept {
  if (frame.extended || frame.error || frame.id > kMaxStandardId) return std::nullopt;
  return Address{static_cast<int>(frame.id >> kCommandBits),
                 static_cast<Command>(frame.id & ((1U << kCommandBits) - 1))};
}

bool Knows(Firmware firmware, Command command) noexcept {
  const auto number = static_cast<int>(command);
  if (number < 0x01 || number == 0x08) return false;
  switch (firmware) {
    case Firmware::k0_5_1:
      return number <= 0x18;
    case Firmware::k0_5_4:
      return number <= 0x1B;
    case Firmware::k0_5_6:
      return number <= 0x1D;
  }
  return false;
}

template <class Message>
Frame Encode(int node, const Message& message, Firmware firmware) noexcept {
  Frame frame;
  frame.id = Identifier(node & kMaxNode, Layout<Message>::kCommand);
  // The DBC gives 8 bytes to every message with signals, except the one-byte question for a
  // voltage.
  const int needed = Layout<Message>::kNeeded;
  frame.length = static_cast<std::uint8_t>(needed <= 1 ? needed : kDbcLength);
  Layout<Message>::Put(message, firmware, frame);
  return frame;
}

template <class Message>
std::optional<Message> Decode(const Frame& frame, Firmware firmware) noexcept {
  const auto address = AddressOf(frame);
  if (!address || frame.remote || frame.length > kMaxDataBytes ||
      address->command != Layout<Message>::kCommand || !Knows(firmware, address->command) ||
      frame.length < Needed<Message>(firmware)) {
    return std::nullopt;
  }
  Message message;
  Layout<Message>::Get(frame, firmware, message);
  return message;
}

#define SINEW_CAN_INSTANTIATE(Message)                                    \
  template Frame Encode<Message>(int, const Message&, Firmware) noexcept; \
  template std::optional<Message> Decode<Message>(const Frame&, Firmware) noexcept;
SINEW_CAN_INSTANTIATE(Heartbeat)
SINEW_CAN_INSTANTIATE(Estop)
SINEW_CAN_INSTANTIATE(MotorError)
SINEW_CAN_INSTANTIATE(EncoderError)
SINEW_CAN_INSTANTIATE(SensorlessError)
SINEW_CAN_INSTANTIATE(ControllerError)
SINEW_CAN_INSTANTIATE(SetAxisNodeId)
SINEW_CAN_INSTANTIATE(SetAxisState)
SINEW_CAN_INSTANTIATE(EncoderEstimates)
SINEW_CAN_INSTANTIATE(EncoderCount)
SINEW_CAN_INSTANTIATE(SetControllerMode)
SINEW_CAN_INSTANTIATE(SetInputPos)
SINEW_CAN_INSTANTIATE(SetInputVel)
SINEW_CAN_INSTANTIATE(SetInputTorque)
SINEW_CAN_INSTANTIATE(SetLimits)
SINEW_CAN_INSTANTIATE(StartAnticogging)
SINEW_CAN_INSTANTIATE(SetTrajVelLimit)
SINEW_CAN_INSTANTIATE(SetTrajAccelLimits)
SINEW_CAN_INSTANTIATE(SetTrajInertia)
SINEW_CAN_INSTANTIATE(Iq)
SINEW_CAN_INSTANTIATE(SensorlessEstimates)
SINEW_CAN_INSTANTIATE(Reboot)
SINEW_CAN_INSTANTIATE(BusVoltageCurrent)
SINEW_CAN_INSTANTIATE(ClearErrors)
SINEW_CAN_INSTANTIATE(SetLinearCount)
SINEW_CAN_INSTANTIATE(SetPosGain)
SINEW_CAN_INSTANTIATE(SetVelGains)
SINEW_CAN_INSTANTIATE(AdcVoltage)
SINEW_CAN_INSTANTIATE(AdcRequest)
#undef SINEW_CAN_INSTANTIATE

Frame EncodeRequest(int node, Command command) noexcept {
  Frame frame;
  frame.id = Identifier(node & kMaxNode, command);
  frame.remote = true;
  frame.length = kDbcLength;
  return frame;
}

bool IsRequest(const Frame& frame, Firmware firmware) noexcept {
  const auto address = AddressOf(frame);
  if (!address || !IsGet(address->command) || !Knows(firmware, address->command)) return false;
  return frame.remote || (firmware == Firmware::k0_5_6 && frame.length == 0);
}

bool CommandsAxis(const Frame& frame, Firmware firmware) noexcept {
  return Decode<SetAxisNodeId>(frame, firmware) || Decode<SetAxisState>(frame, firmware) ||
         Decode<SetControllerMode>(frame, firmware) || Decode<SetInputPos>(frame, firmware) ||
         Decode<SetInputVel>(frame, firmware) || Decode<SetInputTorque>(frame, firmware);
}

Frame Trim(Frame frame) noexcept {
  const auto address = AddressOf(frame);
  if (!address || frame.remote || frame.length != kDbcLength) return frame;
  switch (address->command) {
    case Command::kSetAxisNodeId:
    case Command::kSetAxisState:
    case Command::kSetInputTorque:
    case Command::kSetTrajVelLimit:
    case Command::kSetTrajInertia:
    case Command::kSetLinearCount:
    case Command::kSetPosGain:
      frame.length = 4;
      break;
    default:
      break;
  }
  return frame;
}

}  // namespace sinew::can
