// Inputs through a pipe: the reading code is that of devices. A joystick of the kernel's own is in
// tests/kernel; a GPIO line is not (Debian's kernel has no gpio-sim).
#include "components/robot/estop/inputs.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <linux/gpio.h>
#include <linux/joystick.h>
#include <unistd.h>

#include "components/base/config/config.h"
#include "components/robot/estop/assertion.h"
#include "tests/support/temporary_folder.h"

namespace sinew::estop {
namespace {

using ::testing::HasSubstr;

class Line {
 public:
  Line() { EXPECT_EQ(::pipe2(ends_, O_NONBLOCK | O_CLOEXEC), 0); }
  ~Line() { End(); }
  void End() {
    if (ends_[1] >= 0) ::close(ends_[1]);
    ends_[1] = -1;
  }
  template <class Event>
  void Send(const Event& event, std::size_t bytes = sizeof(Event), std::size_t from = 0) {
    EXPECT_EQ(::write(ends_[1], reinterpret_cast<const char*>(&event) + from, bytes),
              static_cast<ssize_t>(bytes));
  }
  std::unique_ptr<Input> Open(std::unique_ptr<EventDecoder> decoder, bool pressed = false) {
    return std::make_unique<Input>(
        "line", [this, pressed] { return OpenDevice{.descriptor = ends_[0], .pressed = pressed}; },
        std::move(decoder));
  }

 private:
  int ends_[2] = {-1, -1};
};

js_event Button(int number, int value, int init = 0) {
  js_event event{};
  event.type = static_cast<__u8>(JS_EVENT_BUTTON | init);
  event.number = static_cast<__u8>(number);
  event.value = static_cast<__s16>(value);
  return event;
}

gpio_v2_line_event Edge(std::uint32_t id) {
  gpio_v2_line_event event{};
  event.id = id;
  return event;
}

TEST(EstopInputs, AJoysticksOwnButtonStopsAndNoOther) {
  Line line;
  const auto input = line.Open(JoystickDecoder(2));
  line.Send(Button(1, 1));
  js_event axis{};
  axis.type = JS_EVENT_AXIS;
  axis.number = 2;
  axis.value = 32767;
  line.Send(axis);
  line.Send(Button(2, 0, JS_EVENT_INIT));
  EXPECT_FALSE(input->Read());
  EXPECT_FALSE(input->stops());
  line.Send(Button(2, 1));
  EXPECT_TRUE(input->Read());
  EXPECT_TRUE(input->stops()) << "while it is held";
  line.Send(Button(2, 0));
  EXPECT_FALSE(input->Read());
  EXPECT_FALSE(input->stops());
}

TEST(EstopInputs, AButtonThatIsHeldAtTheStartStops) {
  Line line;
  const auto input = line.Open(JoystickDecoder(0));
  line.Send(Button(0, 1, JS_EVENT_INIT));
  EXPECT_TRUE(input->Read());
}

TEST(EstopInputs, AShortPressIsNotLostBetweenTwoReadings) {
  Line line;
  const auto input = line.Open(JoystickDecoder(0));
  line.Send(Button(0, 1));
  line.Send(Button(0, 0));
  EXPECT_TRUE(input->Read());
  EXPECT_FALSE(input->stops());
}

TEST(EstopInputs, AnEventInPartsIsOneEvent) {
  Line line;
  const auto input = line.Open(JoystickDecoder(0));
  const js_event event = Button(0, 1);
  line.Send(event, 5);
  EXPECT_FALSE(input->Read());
  line.Send(event, sizeof event - 5, 5);
  EXPECT_TRUE(input->Read());
}

TEST(EstopInputs, ALineStopsAtItsLevelAndALineThatIsNotUnderstoodStops) {
  Line low_line, high_line;
  const auto low = low_line.Open(GpioDecoder(StopLevel::kLow));
  const auto high = high_line.Open(GpioDecoder(StopLevel::kHigh));
  low_line.Send(Edge(GPIO_V2_LINE_EVENT_FALLING_EDGE));
  high_line.Send(Edge(GPIO_V2_LINE_EVENT_FALLING_EDGE));
  EXPECT_TRUE(low->Read());
  EXPECT_FALSE(high->Read());
  low_line.Send(Edge(GPIO_V2_LINE_EVENT_RISING_EDGE));
  high_line.Send(Edge(GPIO_V2_LINE_EVENT_RISING_EDGE));
  EXPECT_FALSE(low->Read());
  EXPECT_FALSE(low->stops());
  EXPECT_TRUE(high->Read());
  low_line.Send(Edge(7));
  EXPECT_TRUE(low->Read());
}

TEST(EstopInputs, ALineAtItsLevelWhenItIsOpenedStops) {
  Line line;
  EXPECT_TRUE(line.Open(GpioDecoder(StopLevel::kLow), true)->stops());
}

TEST(EstopInputs, ALostInputStopsUntilItIsBack) {
  Line first, second;
  std::vector<std::unique_ptr<Input>> keep;
  int opened = 0, pipe_ends[2] = {-1, -1};
  ASSERT_EQ(::pipe2(pipe_ends, O_NONBLOCK | O_CLOEXEC), 0);
  Input input(
      "stick",
      [&]() -> OpenDevice {
        ++opened;
        if (opened == 1) return {.descriptor = pipe_ends[0]};
        if (opened == 2) return {.why = "stick: unplugged"};
        const int again = ::open("/dev/zero", O_RDONLY | O_CLOEXEC);  // anything that opens
        return {.descriptor = again};
      },
      JoystickDecoder(0));
  EXPECT_FALSE(input.stops());
  ::close(pipe_ends[1]);
  EXPECT_TRUE(input.Read()) << "the end of an input is a press";
  EXPECT_TRUE(input.lost());
  EXPECT_TRUE(input.stops());
  EXPECT_THAT(input.why(), HasSubstr("end of the input"));
  EXPECT_FALSE(input.Read()) << "reported once";
  EXPECT_FALSE(input.Reopen());
  EXPECT_TRUE(input.stops());
  EXPECT_TRUE(input.Reopen());
  EXPECT_FALSE(input.stops());
}

TEST(EstopInputs, AReadErrorIsALoss) {
  const testing::TemporaryFolder folder;  // a folder opens and cannot be read
  Input input(
      "stick",
      [&]() -> OpenDevice {
        return {.descriptor = ::open(folder.path().c_str(), O_RDONLY | O_CLOEXEC)};
      },
      JoystickDecoder(0));
  EXPECT_TRUE(input.Read());
  EXPECT_TRUE(input.lost());
}

TEST(EstopInputs, EveryKeyIsAPress) {
  Line line;
  const auto input = line.Open(KeyDecoder());
  line.Send('\n');
  EXPECT_TRUE(input->Read());
  EXPECT_FALSE(input->stops());
}

TEST(EstopInputs, ADeviceThatIsNotThereIsLostAndNonsenseIsAnError) {
  EXPECT_TRUE(OpenJoystick("/dev/input/js97", 0)->lost());
  const auto line = OpenGpio("/dev/gpiochip97:4:high");
  EXPECT_TRUE(line->lost());
  EXPECT_THAT(line->why(), HasSubstr("/dev/gpiochip97"));
  EXPECT_THROW((void)OpenGpio("/dev/gpiochip0"), UsageError);
  EXPECT_THROW((void)OpenGpio("/dev/gpiochip0:x"), UsageError);
  EXPECT_THROW((void)OpenGpio(":4"), UsageError);
  EXPECT_THROW((void)OpenGpio("/dev/gpiochip0:4:low"), UsageError);
}

TEST(EstopAssertion, SendsAtOnceAndAgainUntilTheRobotHasStopped) {
  Assertion assertion;
  const std::int64_t step = Assertion::kRepeat_ns;
  EXPECT_FALSE(assertion.Due(false, false, 0));
  assertion.Press();
  EXPECT_TRUE(assertion.Due(false, false, 1));
  EXPECT_FALSE(assertion.Due(false, false, 2)) << "not in every loop";
  EXPECT_TRUE(assertion.Due(false, false, 1 + step));
  EXPECT_FALSE(assertion.Due(false, true, 2 + 2 * step)) << "confirmed";
  EXPECT_FALSE(assertion.Due(false, false, 2 + 3 * step)) << "a reset is the operator's";
}

TEST(EstopAssertion, AStateFromBeforeThePressDoesNotConfirmIt) {
  Assertion assertion;
  assertion.Press();
  EXPECT_TRUE(assertion.Due(false, true, 1));
  EXPECT_TRUE(assertion.pressed());
}

TEST(EstopAssertion, AnotherWaysAnswerConfirmsWhatWasSentOnly) {
  Assertion assertion;
  assertion.Press();
  assertion.Confirm();
  EXPECT_TRUE(assertion.Due(false, false, 1)) << "of an earlier press";
  assertion.Confirm();
  EXPECT_FALSE(assertion.pressed());
}

TEST(EstopAssertion, AnInputThatIsHeldKeepsTheRobotStopped) {
  Assertion assertion;
  EXPECT_TRUE(assertion.Due(true, false, 0)) << "somebody has reset";
  EXPECT_FALSE(assertion.Due(true, true, Assertion::kRepeat_ns));
  EXPECT_TRUE(assertion.Due(true, false, 2 * Assertion::kRepeat_ns));
  EXPECT_FALSE(assertion.Due(false, false, 3 * Assertion::kRepeat_ns)) << "released";
}

}  // namespace
}  // namespace sinew::estop
