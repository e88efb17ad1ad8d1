// The master's side of the compact exchange with one gateway (bridge/can/compact.h): collects
// references, puts states together. A state counts when all its frames came, in their order.
// One thread; allocates nothing.
#pragma once

#include <array>
#include <cstdint>

#include "bridge/can/compact.h"
#include "bridge/can/transport/transport.h"

namespace sinew::bridge {

class CompactLink {
 public:
  explicit CompactLink(int node) : node_(node) {}

  // Whether a position is inside its field, not held at its end.
  static bool Fits(double turns);

  // False, and nothing changes, when it does not fit. Starts at 0.
  bool SetReference(int field, double turns);
  std::array<can::Frame, can::kCompactReferenceFrames> References() const {
    return can::EncodeReferences(node_, references_);
  }

  enum class Taken { kNotOurs, kRefused, kPart, kComplete };
  // kRefused: too short, or a frame before it was lost.
  Taken Take(const can::Received& received);
  // The last complete state; stamp_ns is its first frame's, 0 before there is one.
  const can::CompactState& state() const { return state_; }
  std::int64_t stamp_ns() const { return stamp_ns_; }

 private:
  int node_;
  can::CompactReferences references_;
  can::CompactState coming_, state_;
  int next_frame_ = 0;
  std::int64_t coming_ns_ = 0, stamp_ns_ = 0;
};

// Body to world; roll about x, then pitch about y, then yaw about z of the world.
std::array<double, 4> QuaternionOf(const std::array<double, 3>& roll_pitch_yaw_rad);

}  // namespace sinew::bridge
