// The estop's joystick on a real kernel: a joystick that uinput makes, read through joydev.
#include <dirent.h>
#include <fcntl.h>
#include <gtest/gtest.h>
#include <linux/uinput.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <chrono>
#include <cstring>
#include <filesystem>
#include <functional>
#include <string>

#include "components/robot/estop/inputs.h"
#include "tests/support/skip.h"

namespace sinew::estop {
namespace {

constexpr int kStopButton = 1;  // BTN_THUMB, the second of the joystick's buttons

bool Within(std::chrono::seconds limit, const std::function<bool()>& condition) {
  const auto end = std::chrono::steady_clock::now() + limit;
  while (!condition()) {
    if (std::chrono::steady_clock::now() > end) return false;
    ::poll(nullptr, 0, 1);
  }
  return true;
}

// A joystick with an axis and two buttons, plugged in while this exists.
class Joystick {
 public:
  explicit Joystick(int uinput) : uinput_(uinput) {
    uinput_setup setup{};
    setup.id = {.bustype = BUS_USB, .vendor = 0x1234, .product = 0x5678, .version = 1};
    std::strcpy(setup.name, "sinew joystick");
    uinput_abs_setup axis{};
    axis.code = ABS_X;
    axis.absinfo.minimum = -100;
    axis.absinfo.maximum = 100;
    char name[32] = "";
    if (::ioctl(uinput_, UI_SET_EVBIT, EV_KEY) != 0 ||
        ::ioctl(uinput_, UI_SET_EVBIT, EV_ABS) != 0 ||
        ::ioctl(uinput_, UI_SET_KEYBIT, BTN_TRIGGER) != 0 ||
        ::ioctl(uinput_, UI_SET_KEYBIT, BTN_THUMB) != 0 ||
        ::ioctl(uinput_, UI_ABS_SETUP, &axis) != 0 || ::ioctl(uinput_, UI_DEV_SETUP, &setup) != 0 ||
        ::ioctl(uinput_, UI_DEV_CREATE) != 0 ||
        ::ioctl(uinput_, UI_GET_SYSNAME(sizeof name), name) < 0) {
      ADD_FAILURE() << "uinput: " << std::strerror(errno);
      return;
    }
    folder_ = std::string("/sys/devices/virtual/input/") + name;
  }
  ~Joystick() { Unplug(); }

  // Its node under /dev; empty: the kernel made none.
  std::string Device() const {
    std::string node;
    const auto found = [&] {
      std::error_code error;
      for (const auto& entry : std::filesystem::directory_iterator(folder_, error)) {
        if (entry.path().filename().string().starts_with("js")) {
          node = "/dev/input/" + entry.path().filename().string();
        }
      }
      return !node.empty() && std::filesystem::exists(node);
    };
    return Within(std::chrono::seconds(10), found) ? node : "";
  }

  void Set(int button, int value) {
    input_event events[2] = {};
    events[0].type = EV_KEY;
    events[0].code = static_cast<__u16>(button);
    events[0].value = value;
    events[1].type = EV_SYN;
    EXPECT_EQ(::write(uinput_, events, sizeof events), static_cast<ssize_t>(sizeof events));
  }

  void Unplug() {
    if (uinput_ < 0) return;
    ::ioctl(uinput_, UI_DEV_DESTROY);
    ::close(uinput_);
    uinput_ = -1;
  }

 private:
  int uinput_;
  std::string folder_;
};

TEST(JoystickOnAKernel, ItsButtonStopsAndPullingItsPlugToo) {
  const int uinput = ::open("/dev/uinput", O_WRONLY | O_NONBLOCK | O_CLOEXEC);
  SKIP_WITHOUT_KERNEL(uinput >= 0, "uinput");
  Joystick joystick(uinput);
  const std::string device = joystick.Device();
  SKIP_WITHOUT_KERNEL(!device.empty(), "joydev");

  const auto input = OpenJoystick(device, kStopButton);
  ASSERT_FALSE(input->lost()) << input->why();
  EXPECT_FALSE(input->stops());
  const auto stops = [&] {
    (void)input->Read();
    return input->stops();
  };
  joystick.Set(BTN_TRIGGER, 1);  // another button, and back: in order before the one that stops
  joystick.Set(BTN_TRIGGER, 0);
  EXPECT_FALSE(Within(std::chrono::seconds(1), stops)) << "another button stopped the robot";
  joystick.Set(BTN_THUMB, 1);
  EXPECT_TRUE(Within(std::chrono::seconds(5), stops));
  joystick.Set(BTN_THUMB, 0);
  EXPECT_TRUE(Within(std::chrono::seconds(5), [&] { return !stops(); }));
  // Held when it is opened: the kernel's initial events say so.
  joystick.Set(BTN_THUMB, 1);
  const auto second = OpenJoystick(device, kStopButton);
  EXPECT_TRUE(Within(std::chrono::seconds(5), [&] {
    (void)second->Read();
    return second->stops();
  }));
  joystick.Unplug();
  EXPECT_TRUE(Within(std::chrono::seconds(5), [&] {
    (void)input->Read();
    return input->lost();
  }));
  EXPECT_TRUE(input->stops());
}

}  // namespace
}  // namespace sinew::estop
