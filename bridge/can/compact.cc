#include "bridge/can/compact.h"

#include "bridge/can/bytes.h"

namespace sinew::can {
namespace {

constexpr int kFirstReference = 0x01;
constexpr int kFirstState = 0x04;
constexpr int kFieldsPerFrame = 4;
constexpr int kLastFrame = kCompactStateFrames - 1;
constexpr int kLastLength = 4;

// Field i of the state in the order of the frames: where its value is and what one count means.
struct Field {
  double* value = nullptr;
  double step = 1.0;
};

Field StateField(CompactState& state, int i) {
  const auto at = [](auto& values, int k) { return &values[static_cast<std::size_t>(k)]; };
  if (i < 12) return {at(state.position_turns, i), 0.01};
  if (i < 24) return {at(state.velocity_turns_s, i - 12), 0.1};
  if (i < 36) return {at(state.iq_A, i - 24), 0.01};
  if (i < 44) return {at(state.force_N, i - 36), 0.1};
  if (i < 47) return {at(state.acceleration_m_s2, i - 44), 0.01};
  if (i < 50) return {at(state.angular_velocity_rad_s, i - 47), 0.001};
  return {at(state.roll_pitch_yaw_rad, i - 50), 0.0001};
}

Frame Make(int node, int number, int length) {
  Frame frame;
  frame.id = Identifier(node & kMaxNode, static_cast<Command>(number));
  frame.length = static_cast<std::uint8_t>(length);
  return frame;
}

// Number of the frame counted from `first`, or -1.
int Number(int node, const Frame& frame, int first, int count) {
  const auto address = AddressOf(frame);
  if (!address || frame.remote || address->node != node || frame.length > kMaxDataBytes) return -1;
  const int number = static_cast<int>(address->command) - first;
  return number >= 0 && number < count ? number : -1;
}

}  // namespace

std::array<Frame, kCompactReferenceFrames> EncodeReferences(
    int gateway_node, const CompactReferences& references) noexcept {
  std::array<Frame, kCompactReferenceFrames> frames;
  for (int k = 0; k < kCompactReferenceFrames; ++k) {
    Frame frame = Make(gateway_node, kFirstReference + k, 8);
    for (int i = 0; i < kFieldsPerFrame; ++i) {
      const double turns =
          references.position_turns[static_cast<std::size_t>(kFieldsPerFrame * k + i)];
      PutInteger(frame, 2 * i, Quantise<std::int16_t>(turns, 0.01));
    }
    frames[static_cast<std::size_t>(k)] = frame;
  }
  return frames;
}

bool DecodeReferences(int gateway_node, const Frame& frame,
                      CompactReferences* references) noexcept {
  const int k = Number(gateway_node, frame, kFirstReference, kCompactReferenceFrames);
  if (k < 0 || frame.length < 8) return false;
  for (int i = 0; i < kFieldsPerFrame; ++i) {
    references->position_turns[static_cast<std::size_t>(kFieldsPerFrame * k + i)] =
        0.01 * GetInteger<std::int16_t>(frame, 2 * i);
  }
  return true;
}

std::array<Frame, kCompactStateFrames> EncodeState(int gateway_node,
                                                   const CompactState& state) noexcept {
  CompactState copy = state;  // StateField points into a mutable one
  std::array<Frame, kCompactStateFrames> frames;
  for (int k = 0; k < kCompactStateFrames; ++k) {
    const bool last = k == kLastFrame;
    Frame frame = Make(gateway_node, kFirstState + k, last ? kLastLength : 8);
    for (int i = 0; i < (last ? 1 : kFieldsPerFrame); ++i) {
      const Field field = StateField(copy, kFieldsPerFrame * k + i);
      PutInteger(frame, 2 * i, Quantise<std::int16_t>(*field.value, field.step));
    }
    if (last) frame.data[2] = state.sequence;
    frames[static_cast<std::size_t>(k)] = frame;
  }
  return frames;
}

bool DecodeState(int gateway_node, const Frame& frame, CompactState* state) noexcept {
  const int k = Number(gateway_node, frame, kFirstState, kCompactStateFrames);
  if (k < 0) return false;
  const bool last = k == kLastFrame;
  if (frame.length < (last ? kLastLength : 8)) return false;
  for (int i = 0; i < (last ? 1 : kFieldsPerFrame); ++i) {
    const Field field = StateField(*state, kFieldsPerFrame * k + i);
    *field.value = field.step * GetInteger<std::int16_t>(frame, 2 * i);
  }
  if (last) state->sequence = frame.data[2];
  return true;
}

int StateFrameNumber(int gateway_node, const Frame& frame) noexcept {
  return Number(gateway_node, frame, kFirstState, kCompactStateFrames);
}

int ReferenceFrameNumber(int gateway_node, const Frame& frame) noexcept {
  return Number(gateway_node, frame, kFirstReference, kCompactReferenceFrames);
}

Command StateCommand(int number) { return static_cast<Command>(kFirstState + number); }

}  // namespace sinew::can
