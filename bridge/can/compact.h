// The compact exchange of a whole robot through one gateway: 12 references out; 12 positions, 12
// velocities, 12 Iq, 8 forces and 9 IMU values in, as packed 16-bit fields. Pure.
//
// Source: thesis 3.2.3: positions are motor turns x 100 as int16 (0.072 degrees worst case at the
// output of a 50:1 gear). The other scales are ours. Identifier = gateway node * 32 + frame number:
//
//   0x01-0x03  references   4 x int16, 0.01 motor turns
//   0x04-0x06  positions    4 x int16, 0.01 motor turns
//   0x07-0x09  velocities   4 x int16, 0.1 motor turns/s
//   0x0A-0x0C  Iq           4 x int16, 0.01 A
//   0x0D-0x0E  forces       4 x int16, 0.1 N
//   0x0F-0x10  IMU 0-3, 4-7 4 x int16; 0x11 IMU 8, sequence
//              values 0-2 acceleration 0.01 m/s^2, 3-5 angular velocity 0.001 rad/s, 6-8 roll,
//              pitch, yaw 0.0001 rad
//
// 17 frames of 8 bytes (the last of 4) take at most 2.255 ms at 1 Mbit/s with worst stuffing: 443
// cycles a second. Fields are held at their ends; NaN is sent as 0. Any thread; allocates nothing.
#pragma once

#include <array>
#include <cstdint>

#include "bridge/can/codec.h"
#include "bridge/can/frame.h"
#include "components/base/types/joints.h"

namespace sinew::can {

// Joints of the wire format: three frames of four fields. Every joint of a robot has a field.
inline constexpr int kCompactJoints = 12;
static_assert(kCompactJoints == types::kMaxJoints);
inline constexpr int kCompactForces = 8;
inline constexpr int kCompactReferenceFrames = 3;
inline constexpr int kCompactStateFrames = 14;

struct CompactReferences {
  std::array<double, kCompactJoints> position_turns{};
  friend bool operator==(const CompactReferences&, const CompactReferences&) = default;
};

struct CompactState {
  std::array<double, kCompactJoints> position_turns{};
  std::array<double, kCompactJoints> velocity_turns_s{};
  std::array<double, kCompactJoints> iq_A{};
  std::array<double, kCompactForces> force_N{};
  std::array<double, 3> acceleration_m_s2{};
  std::array<double, 3> angular_velocity_rad_s{};
  std::array<double, 3> roll_pitch_yaw_rad{};
  std::uint8_t sequence = 0;
  friend bool operator==(const CompactState&, const CompactState&) = default;
};

std::array<Frame, kCompactReferenceFrames> EncodeReferences(
    int gateway_node, const CompactReferences& references) noexcept;
std::array<Frame, kCompactStateFrames> EncodeState(int gateway_node,
                                                   const CompactState& state) noexcept;

// Takes in one frame; false when it is none of this gateway's (or too short), and nothing changes.
bool DecodeReferences(int gateway_node, const Frame& frame, CompactReferences* references) noexcept;
bool DecodeState(int gateway_node, const Frame& frame, CompactState* state) noexcept;

// The number of a state's (references') frame by its identifier, counted from 0; -1: none.
int StateFrameNumber(int gateway_node, const Frame& frame) noexcept;
int ReferenceFrameNumber(int gateway_node, const Frame& frame) noexcept;
Command StateCommand(int number);

}  // namespace sinew::can
