// Inputs that a person presses: a joystick's button, a GPIO line, a key. How to add a device: an
// EventDecoder for its events and a way to open it; the rest is here.
//
// An input is pressed, released or lost. Lost (unplugged, read error, end of file) is an estop as a
// pressed one is, for as long as it lasts: a robot whose button is not there is not armed.
//
// Decoders are pure: bytes in, presses out. Thread: one.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "components/base/config/descriptor.h"

namespace sinew::estop {

// Decoder of a device whose events have one size.
class EventDecoder {
 public:
  virtual ~EventDecoder() = default;
  virtual std::size_t event_bytes() const = 0;
  enum class News { kNothing, kPressed, kReleased, kStruck };  // kStruck: pressed and released
  virtual News Decode(std::span<const std::byte> event) = 0;
};

// struct js_event of <linux/joystick.h>; its initial events say what is held at the start.
std::unique_ptr<EventDecoder> JoystickDecoder(int button);
// struct gpio_v2_line_event of <linux/gpio.h>. stop_level: the level of the line that stops. Low: a
// normally closed contact to the supply, so that a broken wire stops, too.
enum class StopLevel { kLow, kHigh };
std::unique_ptr<EventDecoder> GpioDecoder(StopLevel stop_level);
// Any byte is a press.
std::unique_ptr<EventDecoder> KeyDecoder();

// An open device. pressed: what it says itself about the start.
struct OpenDevice {
  int descriptor = -1;  // non-blocking; -1: could not be opened
  bool pressed = false;
  std::string why = {};  // could not be opened
};

class Input {
 public:
  // `open` is called at once, and by Reopen. The descriptor is this object's from then on.
  Input(std::string name, std::function<OpenDevice()> open, std::unique_ptr<EventDecoder> decoder);

  // Everything that waits. True: pressed or lost by it.
  bool Read();
  // Opens a lost input again. True: it is back.
  bool Reopen();

  int descriptor() const { return descriptor_.get(); }  // for poll(); -1: lost
  bool lost() const { return descriptor() < 0; }
  bool stops() const { return pressed_ || lost(); }
  const std::string& name() const { return name_; }
  const std::string& why() const { return why_; }  // lost: the reason

 private:
  void Open();
  void Lose(const std::string& why);

  std::string name_;
  std::function<OpenDevice()> open_;
  std::unique_ptr<EventDecoder> decoder_;
  config::Descriptor descriptor_;
  bool pressed_ = false;
  std::string why_;
  std::vector<std::byte> rest_;  // the begin of an event whose end has not come yet
};

// The devices. Throws UsageError for what cannot be meant: a button that the joystick does not
// have, a text that is no "CHIP:LINE" or "CHIP:LINE:high". A device that is not there is lost, not
// an error.
std::unique_ptr<Input> OpenJoystick(const std::string& device, int button);
std::unique_ptr<Input> OpenGpio(const std::string& chip_and_line);
// The terminal of standard input, without waiting for Enter while this exists; or a pipe.
std::unique_ptr<Input> OpenKeys();

}  // namespace sinew::estop
