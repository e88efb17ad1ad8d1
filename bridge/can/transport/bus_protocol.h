// Packets between sinew-can-bus and the processes that join it: one of 32 bytes per event (classic
// frames), over Unix-domain sequenced-packet sockets of one machine (host byte order).
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "bridge/can/frame.h"

namespace sinew::can {

enum class PacketKind : std::uint8_t {
  kWelcome = 1,  // server -> client, first: value is the bit rate
  kFrame = 2,    // client -> server: to be sent; server -> client: seen on the bus at stamp_ns
  kDropped = 3,  // server -> client: a frame found no space
  kHealth = 4,   // server -> client: value is the client's NodeHealth
  kError = 5,    // server -> client: an error frame was on the bus
};

struct Packet {
  static constexpr std::uint16_t kMagic = 0x5C01;  // with the version in the low byte
  std::uint16_t magic = kMagic;
  PacketKind kind{};
  std::uint8_t flags = 0;  // 1: extended, 2: remote
  std::uint32_t id = 0;
  std::uint32_t value = 0;
  std::uint8_t length = 0;
  std::array<std::uint8_t, 3> reserved{};
  std::int64_t stamp_ns = 0;  // CLOCK_MONOTONIC, end of the frame
  std::array<std::uint8_t, kMaxDataBytes> data{};
};
static_assert(sizeof(Packet) == 32);

inline Packet FramePacket(const Frame& frame, std::int64_t stamp_ns) {
  Packet packet;
  packet.kind = PacketKind::kFrame;
  packet.flags = static_cast<std::uint8_t>((frame.extended ? 1 : 0) | (frame.remote ? 2 : 0));
  packet.id = frame.id;
  packet.length = frame.length;
  std::copy_n(frame.data.begin(), packet.data.size(), packet.data.begin());
  packet.stamp_ns = stamp_ns;
  return packet;
}

inline Frame FrameOf(const Packet& packet) {
  Frame frame;
  frame.id = packet.id;
  frame.extended = (packet.flags & 1) != 0;
  frame.remote = (packet.flags & 2) != 0;
  frame.length = packet.length;
  std::copy(packet.data.begin(), packet.data.end(), frame.data.begin());
  return frame;
}

}  // namespace sinew::can
