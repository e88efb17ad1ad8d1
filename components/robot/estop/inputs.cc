#include "components/robot/estop/inputs.h"

#include <fcntl.h>
#include <linux/gpio.h>
#include <linux/joystick.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <utility>

#include "components/base/config/config.h"

namespace sinew::estop {
namespace {

template <class Event>
Event EventOf(std::span<const std::byte> bytes) {
  Event event;
  std::memcpy(&event, bytes.data(), sizeof event);
  return event;
}

class Joystick final : public EventDecoder {
 public:
  explicit Joystick(int button) : button_(button) {}
  std::size_t event_bytes() const override { return sizeof(js_event); }
  News Decode(std::span<const std::byte> bytes) override {
    const auto event = EventOf<js_event>(bytes);
    if ((event.type & ~JS_EVENT_INIT) != JS_EVENT_BUTTON || event.number != button_) {
      return News::kNothing;
    }
    return event.value != 0 ? News::kPressed : News::kReleased;
  }

 private:
  int button_;
};

class Gpio final : public EventDecoder {
 public:
  explicit Gpio(StopLevel stop_level)
      : stops_(stop_level == StopLevel::kLow ? GPIO_V2_LINE_EVENT_FALLING_EDGE
                                             : GPIO_V2_LINE_EVENT_RISING_EDGE) {}
  std::size_t event_bytes() const override { return sizeof(gpio_v2_line_event); }
  News Decode(std::span<const std::byte> bytes) override {
    const auto event = EventOf<gpio_v2_line_event>(bytes);
    // An event that is no edge is a stop: the line is not understood.
    const bool rising_or_falling =
        event.id == GPIO_V2_LINE_EVENT_RISING_EDGE || event.id == GPIO_V2_LINE_EVENT_FALLING_EDGE;
    return event.id == stops_ || !rising_or_falling ? News::kPressed : News::kReleased;
  }

 private:
  std::uint32_t stops_;
};

class Keys final : public EventDecoder {
 public:
  std::size_t event_bytes() const override { return 1; }
  News Decode(std::span<const std::byte>) override { return News::kStruck; }
};

OpenDevice Absent(const std::string& what) { return {.why = what + ": " + std::strerror(errno)}; }

void CheckButton(int descriptor, const std::string& device, int button) {
  __u8 buttons = 0;
  // A FIFO or another stand-in has no such call, and then as many buttons as it sends.
  if (::ioctl(descriptor, JSIOCGBUTTONS, &buttons) != 0 || button < buttons) return;
  ::close(descriptor);
  throw UsageError("--button: " + std::to_string(button) + ", but " + device + " has " +
                   std::to_string(buttons) + " buttons, counted from 0");
}

// Requests the line as an input with events on both edges.
OpenDevice OpenLine(const std::string& chip, unsigned line, StopLevel stop_level) {
  const int device = ::open(chip.c_str(), O_RDWR | O_CLOEXEC);
  if (device < 0) return Absent(chip);
  gpio_v2_line_request request{};
  request.offsets[0] = line;
  request.num_lines = 1;
  std::strncpy(request.consumer, "sinew-estop", sizeof request.consumer - 1);
  // The bias pulls an open contact to the level that stops.
  request.config.flags = GPIO_V2_LINE_FLAG_INPUT | GPIO_V2_LINE_FLAG_EDGE_RISING |
                         GPIO_V2_LINE_FLAG_EDGE_FALLING |
                         (stop_level == StopLevel::kLow ? GPIO_V2_LINE_FLAG_BIAS_PULL_DOWN
                                                        : GPIO_V2_LINE_FLAG_BIAS_PULL_UP);
  const bool requested = ::ioctl(device, GPIO_V2_GET_LINE_IOCTL, &request) == 0;
  OpenDevice opened = requested ? OpenDevice{.descriptor = request.fd}
                                : Absent(chip + ", line " + std::to_string(line));
  ::close(device);
  if (!requested) return opened;
  gpio_v2_line_values values{.bits = 0, .mask = 1};
  if (::ioctl(request.fd, GPIO_V2_LINE_GET_VALUES_IOCTL, &values) != 0) {
    OpenDevice unread = Absent(chip + ", line " + std::to_string(line));
    ::close(request.fd);
    return unread;
  }
  const bool high = (values.bits & 1) != 0;
  opened.pressed = high == (stop_level == StopLevel::kHigh);
  (void)::fcntl(request.fd, F_SETFL, ::fcntl(request.fd, F_GETFL) | O_NONBLOCK);
  return opened;
}

// Keys one by one, not echoed.
class RawTerminal {
 public:
  RawTerminal() : is_terminal_(::tcgetattr(STDIN_FILENO, &before_) == 0) {
    if (!is_terminal_) return;
    termios raw = before_;
    raw.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO);
    (void)::tcsetattr(STDIN_FILENO, TCSANOW, &raw);
  }
  ~RawTerminal() {
    if (is_terminal_) (void)::tcsetattr(STDIN_FILENO, TCSANOW, &before_);
  }
  RawTerminal(const RawTerminal&) = delete;
  RawTerminal& operator=(const RawTerminal&) = delete;

 private:
  termios before_{};
  bool is_terminal_;
};

}  // namespace

std::unique_ptr<EventDecoder> JoystickDecoder(int button) {
  return std::make_unique<Joystick>(button);
}
std::unique_ptr<EventDecoder> GpioDecoder(StopLevel stop_level) {
  return std::make_unique<Gpio>(stop_level);
}
std::unique_ptr<EventDecoder> KeyDecoder() { return std::make_unique<Keys>(); }

Input::Input(std::string name, std::function<OpenDevice()> open,
             std::unique_ptr<EventDecoder> decoder)
    : name_(std::move(name)), open_(std::move(open)), decoder_(std::move(decoder)) {
  Open();
}

void Input::Open() {
  OpenDevice device = open_();
  descriptor_ = config::Descriptor(device.descriptor);
  pressed_ = device.pressed;
  why_ = std::move(device.why);
  rest_.clear();
}

bool Input::Reopen() {
  if (lost()) Open();
  return !lost();
}

void Input::Lose(const std::string& why) {
  descriptor_.Close();
  pressed_ = false;
  why_ = name_ + ": " + why;
}

bool Input::Read() {
  bool stopped = false;
  std::array<std::byte, 1024> bytes;
  while (!lost()) {
    const ssize_t size = ::read(descriptor(), bytes.data(), bytes.size());
    if (size < 0 && errno == EINTR) continue;
    if (size < 0 && errno == EAGAIN) break;
    if (size <= 0) {
      Lose(size == 0 ? "end of the input" : std::strerror(errno));
      return true;
    }
    rest_.insert(rest_.end(), bytes.begin(), bytes.begin() + size);
    const std::size_t step = decoder_->event_bytes();
    std::size_t done = 0;
    for (; rest_.size() - done >= step; done += step) {
      const auto news = decoder_->Decode(std::span(rest_).subspan(done, step));
      if (news == EventDecoder::News::kNothing) continue;
      pressed_ = news == EventDecoder::News::kPressed;
      stopped = stopped || news != EventDecoder::News::kReleased;
    }
    rest_.erase(rest_.begin(), rest_.begin() + static_cast<std::ptrdiff_t>(done));
  }
  return stopped;
}

std::unique_ptr<Input> OpenJoystick(const std::string& device, int button) {
  const auto open = [device, button]() -> OpenDevice {
    const int descriptor = ::open(device.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
    if (descriptor < 0) return Absent(device);
    CheckButton(descriptor, device, button);
    return {.descriptor = descriptor};
  };
  return std::make_unique<Input>(device + ", button " + std::to_string(button), open,
                                 JoystickDecoder(button));
}

std::unique_ptr<Input> OpenGpio(const std::string& chip_and_line) {
  const auto fail = [&] {
    throw UsageError("--gpio: '" + chip_and_line +
                     "', expected CHIP:LINE or CHIP:LINE:high, such as /dev/gpiochip0:17");
  };
  std::string text = chip_and_line;
  StopLevel stop_level = StopLevel::kLow;
  if (text.ends_with(":high")) {
    stop_level = StopLevel::kHigh;
    text.resize(text.size() - 5);
  }
  const std::size_t colon = text.rfind(':');
  if (colon == std::string::npos || colon == 0) fail();
  unsigned line = 0;
  const char* end = text.data() + text.size();
  const auto parsed = std::from_chars(text.data() + colon + 1, end, line);
  if (parsed.ec != std::errc() || parsed.ptr != end) fail();
  const std::string chip = text.substr(0, colon);
  return std::make_unique<Input>(
      chip_and_line, [=] { return OpenLine(chip, line, stop_level); }, GpioDecoder(stop_level));
}

std::unique_ptr<Input> OpenKeys() {
  auto terminal = std::make_shared<RawTerminal>();
  const auto open = [terminal, opened = false]() mutable -> OpenDevice {
    if (std::exchange(opened, true)) return {.why = "standard input: ended"};
    // Opened anew: O_NONBLOCK of a shared one would be the shell's, too.
    const int descriptor = ::open("/proc/self/fd/0", O_RDONLY | O_NONBLOCK | O_CLOEXEC);
    if (descriptor < 0) return Absent("standard input");
    return {.descriptor = descriptor};
  };
  return std::make_unique<Input>("keys", open, KeyDecoder());
}

}  // namespace sinew::estop
