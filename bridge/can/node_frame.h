// Frames of our own nodes: identifier, length, bits. What the codecs of sensor nodes and body nodes
// build on. Any thread; allocates nothing.
#pragma once

#include <cstdint>

#include "bridge/can/codec.h"
#include "bridge/can/frame.h"
#include "bridge/can/sensor_node.h"

namespace sinew::can {

// Empty, with its identifier and length.
inline Frame MakeNodeFrame(int node, NodeCommand command, int length) {
  Frame frame;
  frame.id = Identifier(node & kMaxNode, command);
  frame.length = static_cast<std::uint8_t>(length);
  return frame;
}

// A standard data frame of this command with at least `length` bytes, at most eight.
inline bool IsNodeFrame(const Frame& frame, NodeCommand command, int length) {
  const auto address = AddressOf(frame);
  return address && !frame.remote && static_cast<NodeCommand>(address->command) == command &&
         frame.length >= length && frame.length <= kMaxDataBytes;
}

inline std::uint8_t Bit(bool value, int bit) {
  return static_cast<std::uint8_t>(value ? 1 << bit : 0);
}

inline bool Bit(std::uint8_t bits, int bit) { return (bits >> bit & 1) != 0; }

}  // namespace sinew::can
