#include <cmath>
#include <string>

#include "bridge/can/bit_timing.h"
#include "bridge/can/body_node.h"
#include "bridge/can/codec.h"
#include "bridge/can/compact.h"
#include "bridge/can/sensor_node.h"
#include "tests/fuzz/harness.h"
#include "tests/fuzz/property.h"

namespace sinew::fuzz {
namespace {

using can::Firmware;
using can::Frame;

// Bytes up to the last signal, per firmware (odrive-cansimple.dbc; can_simple.cpp of the tags), and
// the first firmware that has the command. Apart from the codec's own table on purpose.
struct Expected {
  std::uint32_t command;
  int needed_0_5_1;  // -1: unknown to it
  int needed_0_5_4;
  int needed_0_5_6;
};

int Needed(const Expected& expected, Firmware firmware) {
  switch (firmware) {
    case Firmware::k0_5_1:
      return expected.needed_0_5_1;
    case Firmware::k0_5_4:
      return expected.needed_0_5_4;
    case Firmware::k0_5_6:
      break;
  }
  return expected.needed_0_5_6;
}

bool IsPlainData(const Frame& frame) {
  return !frame.extended && !frame.error && !frame.remote && frame.id <= 0x7FF && frame.length <= 8;
}

template <class Message>
void CheckMessage(const Frame& frame, Firmware firmware, const Expected& expected) {
  const auto message = can::Decode<Message>(frame, firmware);
  const int needed = Needed(expected, firmware);
  const bool must = IsPlainData(frame) && (frame.id & 31) == expected.command && needed >= 0 &&
                    frame.length >= needed;
  Check(message.has_value() == must, "decoded where it must not, or refused where it must not");
  if (!message) return;
  const int node = static_cast<int>(frame.id >> 5);
  const Frame once = can::Encode(node, *message, firmware);
  Check(can::IsValid(once) && once.id == frame.id, "encoded to an impossible or foreign frame");
  const auto again = can::Decode<Message>(once, firmware);
  Check(again.has_value(), "what was encoded does not decode");
  // By bytes: NaN is not equal to itself.
  Check(can::Encode(node, *again, firmware) == once, "Decode(Encode(x)) is not x");
  if (*message == *message) Check(*again == *message, "Decode(Encode(x)) is not x");
  const Frame trimmed = can::Trim(once);
  const auto from_trimmed = can::Decode<Message>(trimmed, firmware);
  Check(from_trimmed.has_value() && can::Encode(node, *from_trimmed, firmware) == once,
        "a trimmed frame means something else");
}

void CheckController(const Frame& frame, Firmware firmware) {
  CheckMessage<can::Heartbeat>(frame, firmware, {0x01, 8, 8, 8});
  CheckMessage<can::Estop>(frame, firmware, {0x02, 0, 0, 0});
  CheckMessage<can::MotorError>(frame, firmware, {0x03, 4, 4, 8});
  CheckMessage<can::EncoderError>(frame, firmware, {0x04, 4, 4, 4});
  CheckMessage<can::SensorlessError>(frame, firmware, {0x05, 4, 4, 4});
  CheckMessage<can::SetAxisNodeId>(frame, firmware, {0x06, 4, 4, 4});
  CheckMessage<can::SetAxisState>(frame, firmware, {0x07, 4, 4, 4});
  CheckMessage<can::EncoderEstimates>(frame, firmware, {0x09, 8, 8, 8});
  CheckMessage<can::EncoderCount>(frame, firmware, {0x0A, 8, 8, 8});
  CheckMessage<can::SetControllerMode>(frame, firmware, {0x0B, 8, 8, 8});
  CheckMessage<can::SetInputPos>(frame, firmware, {0x0C, 8, 8, 8});
  CheckMessage<can::SetInputVel>(frame, firmware, {0x0D, 8, 8, 8});
  CheckMessage<can::SetInputTorque>(frame, firmware, {0x0E, 4, 4, 4});
  CheckMessage<can::SetLimits>(frame, firmware, {0x0F, 4, 8, 8});
  CheckMessage<can::StartAnticogging>(frame, firmware, {0x10, 0, 0, 0});
  CheckMessage<can::SetTrajVelLimit>(frame, firmware, {0x11, 4, 4, 4});
  CheckMessage<can::SetTrajAccelLimits>(frame, firmware, {0x12, 8, 8, 8});
  CheckMessage<can::SetTrajInertia>(frame, firmware, {0x13, 4, 4, 4});
  CheckMessage<can::Iq>(frame, firmware, {0x14, 8, 8, 8});
  CheckMessage<can::SensorlessEstimates>(frame, firmware, {0x15, 8, 8, 8});
  CheckMessage<can::Reboot>(frame, firmware, {0x16, 0, 0, 0});
  CheckMessage<can::BusVoltageCurrent>(frame, firmware, {0x17, 4, 4, 8});
  CheckMessage<can::ClearErrors>(frame, firmware, {0x18, 0, 0, 0});
  CheckMessage<can::SetLinearCount>(frame, firmware, {0x19, -1, 4, 4});
  CheckMessage<can::SetPosGain>(frame, firmware, {0x1A, -1, 4, 4});
  CheckMessage<can::SetVelGains>(frame, firmware, {0x1B, -1, 8, 8});
  CheckMessage<can::AdcVoltage>(frame, firmware, {0x1C, -1, -1, 4});
  CheckMessage<can::AdcRequest>(frame, firmware, {0x1C, -1, -1, 1});
  CheckMessage<can::ControllerError>(frame, firmware, {0x1D, -1, -1, 4});
  if (can::IsRequest(frame, firmware)) {
    Check(!frame.extended && !frame.error && frame.id <= 0x7FF, "no standard frame asks");
    Check(frame.remote || frame.length == 0, "a frame with data asks");
  }
}

template <class Message>
void CheckNodeMessage(const Frame& frame, const std::optional<Message>& message,
                      std::uint32_t command, int needed,
                      std::optional<Message> (*decode)(const Frame&) noexcept) {
  const bool must = IsPlainData(frame) && (frame.id & 31) == command && frame.length >= needed;
  Check(message.has_value() == must,
        "a sensor node's frame decoded where it must not, or refused where it must not");
  if (!message) return;
  const Frame once = can::Encode(static_cast<int>(frame.id >> 5), *message);
  Check(can::IsValid(once) && once.id == frame.id, "encoded to an impossible or foreign frame");
  const auto again = decode(once);
  Check(again.has_value() && *again == *message, "Decode(Encode(x)) is not x");
}

void CheckNode(const Frame& frame) {
  CheckNodeMessage(frame, can::DecodeNodeHeartbeat(frame), 0x01, 6, can::DecodeNodeHeartbeat);
  CheckNodeMessage(frame, can::DecodeOutputEncoder(frame), 0x09, 8, can::DecodeOutputEncoder);
  CheckNodeMessage(frame, can::DecodeJointSensors(frame), 0x0A, 8, can::DecodeJointSensors);
  CheckNodeMessage(frame, can::DecodeValveCommand(frame), 0x0B, 4, can::DecodeValveCommand);
  CheckNodeMessage(frame, can::DecodeFootForces(frame), 0x0C, 8, can::DecodeFootForces);
  CheckNodeMessage(frame, can::DecodeImuForce(frame), 0x0D, 8, can::DecodeImuForce);
  CheckNodeMessage(frame, can::DecodeImuRate(frame), 0x0E, 8, can::DecodeImuRate);
  CheckNodeMessage(frame, can::DecodeImuOrientation(frame), 0x0F, 8, can::DecodeImuOrientation);
}

// What three components stand for is a rotation, or is refused.
void CheckOrientation(const Frame& frame) {
  const auto message = can::DecodeImuOrientation(frame);
  if (!message) return;
  const auto q = can::Restore(*message);
  if (!q) return;
  double square = 0.0;
  for (const double c : *q) square += c * c;
  Check(std::abs(square - 1.0) < 1e-12, "an orientation that is not of length 1");
  const auto again = can::OmitLargest(*q, message->sequence);
  Check(again.has_value() && can::Restore(*again).has_value(), "an orientation cannot be sent on");
}

void CheckGateway(const Frame& frame, int gateway) {
  const auto number = static_cast<int>(frame.id & 31);
  const bool ours = IsPlainData(frame) && static_cast<int>(frame.id >> 5) == gateway;

  can::CompactReferences references;
  references.position_turns.fill(1e9);
  const can::CompactReferences untouched = references;
  const bool took = can::DecodeReferences(gateway, frame, &references);
  Check(took == (ours && number >= 0x01 && number <= 0x03 && frame.length == 8),
        "references taken where they must not be, or refused");
  if (took) {
    const Frame again = can::EncodeReferences(gateway, references)[std::size_t(number - 1)];
    Check(again == frame, "references encode to other bytes");
  } else {
    Check(references == untouched, "a refused frame changed the references");
  }

  can::CompactState state;
  state.position_turns.fill(1e9);
  const can::CompactState still = state;
  const bool took_state = can::DecodeState(gateway, frame, &state);
  Check(took_state ==
            (ours && number >= 0x04 && number <= 0x11 && frame.length >= (number == 0x11 ? 4 : 8)),
        "a state taken where it must not be, or refused");
  if (took_state) {
    const Frame again = can::EncodeState(gateway, state)[std::size_t(number - 4)];
    const std::size_t used = number == 0x11 ? 3 : 8;
    for (std::size_t i = 0; i < used; ++i)
      Check(again.data[i] == frame.data[i], "a state encodes to other bytes");
  } else {
    Check(state == still, "a refused frame changed the state");
  }
}

void CheckTiming(const Frame& frame) {
  const int bits = can::FrameBits(frame);
  const int length = frame.remote ? 0 : std::min<int>(frame.length, 8);
  Check(bits >= 47, "shorter than any frame");
  if (frame.error || !can::IsValid(frame)) return;
  Check(bits <= can::WorstFrameBits(length, frame.extended), "longer than the worst case");
  const int plain = (frame.extended ? 54 : 34) + 8 * length + 13;
  Check(bits >= plain, "shorter than its fields");
}

}  // namespace

void RunCodec(std::span<const std::uint8_t> input) {
  Bytes bytes(input);
  while (!bytes.empty()) {
    const std::uint8_t choice = bytes.Byte();
    const auto firmware = static_cast<Firmware>(choice % 3);
    const Frame frame = bytes.Frame();
    CheckController(frame, firmware);
    CheckNode(frame);
    CheckOrientation(frame);
    CheckGateway(frame, choice >> 2);
    CheckTiming(frame);
  }
}

std::vector<Input> CodecSeeds() {
  std::vector<Input> seeds;
  const auto add = [&seeds](int firmware, int gateway, const Frame& frame) {
    Input seed{static_cast<std::uint8_t>(gateway << 2 | firmware)};
    while (seed[0] % 3 != firmware) ++seed[0];  // the two choices share a byte
    Append(seed, frame);
    seeds.push_back(seed);
  };
  for (std::uint32_t command = 0; command < 32; ++command) {
    for (const std::uint8_t length : {0, 1, 4, 6, 7, 8, 9}) {
      Frame frame;
      frame.id = 3U << 5 | command;
      frame.length = length;
      frame.data = {0x00, 0x00, 0xC0, 0x3F, 0x00, 0x00, 0x10, 0xC0};
      add(static_cast<int>(command % 3), 3, frame);
    }
  }
  for (const can::Frame& frame : can::EncodeState(7, {})) add(2, 7, frame);
  for (const can::Frame& frame : can::EncodeReferences(7, {})) add(2, 7, frame);
  add(2, 0, can::EncodeRequest(9, can::Command::kGetIq));
  return seeds;
}

}  // namespace sinew::fuzz
