// Sending and repetition of an estop: until the robot says that it has stopped, and for as long as
// an input is held or lost.
//
// Pure: time and what was heard come in. Thread: one.
#pragma once

#include <cstdint>

namespace sinew::estop {

class Assertion {
 public:
  // Between repetitions.
  static constexpr std::int64_t kRepeat_ns = 100'000'000;

  // Somebody has pressed; an estop goes out at once and until it is confirmed.
  void Press() { pressed_ = true, sent_ = false; }
  // It has reached the robot, as somebody else than the robot's state says.
  void Confirm() { pressed_ = pressed_ && !sent_; }
  // True: send now.
  bool Due(bool stopping_input, bool robot_is_stopped, std::int64_t now_ns) {
    // The robot's state from before the first sending is no answer to it.
    if (robot_is_stopped && sent_) pressed_ = false;
    const bool wanted = pressed_ || (stopping_input && !robot_is_stopped);
    if (!wanted || (sent_ && now_ns - sent_ns_ < kRepeat_ns)) return false;
    sent_ = true;
    sent_ns_ = now_ns;
    return true;
  }
  bool pressed() const { return pressed_; }  // and not confirmed yet

 private:
  bool pressed_ = false;
  bool sent_ = false;
  std::int64_t sent_ns_ = 0;
};

}  // namespace sinew::estop
