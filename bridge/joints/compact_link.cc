#include "bridge/joints/compact_link.h"

#include <cmath>

namespace sinew::bridge {

bool CompactLink::Fits(double turns) { return std::abs(turns) < 327.67; }

bool CompactLink::SetReference(int field, double turns) {
  if (!Fits(turns)) return false;
  references_.position_turns[static_cast<std::size_t>(field)] = turns;
  return true;
}

CompactLink::Taken CompactLink::Take(const can::Received& received) {
  const int number = can::StateFrameNumber(node_, received.frame);
  if (number < 0) return Taken::kNotOurs;
  if (!can::DecodeState(node_, received.frame, &coming_)) return Taken::kRefused;
  if (number == 0) {
    next_frame_ = 0;
    coming_ns_ = received.stamp_ns;
  }
  if (number != next_frame_) {
    next_frame_ = can::kCompactStateFrames;  // none fits until the next state begins
    return Taken::kRefused;
  }
  if (++next_frame_ < can::kCompactStateFrames) return Taken::kPart;
  state_ = coming_;
  stamp_ns_ = coming_ns_;
  return Taken::kComplete;
}

std::array<double, 4> QuaternionOf(const std::array<double, 3>& roll_pitch_yaw_rad) {
  std::array<double, 3> c, s;
  for (std::size_t i = 0; i < 3; ++i) {
    c[i] = std::cos(0.5 * roll_pitch_yaw_rad[i]);
    s[i] = std::sin(0.5 * roll_pitch_yaw_rad[i]);
  }
  return {c[0] * c[1] * c[2] + s[0] * s[1] * s[2], s[0] * c[1] * c[2] - c[0] * s[1] * s[2],
          c[0] * s[1] * c[2] + s[0] * c[1] * s[2], c[0] * c[1] * s[2] - s[0] * s[1] * c[2]};
}

}  // namespace sinew::bridge
