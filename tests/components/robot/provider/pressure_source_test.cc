#include "components/robot/provider/pressure_source.h"

#include <gtest/gtest.h>

#include <cmath>

namespace sinew::provider {
namespace {

using std::chrono::milliseconds;

constexpr std::uint64_t kPressureSession = 7;

PressureMessage AskPressure(std::uint64_t tick, double pressure_bar,
                            std::uint64_t session = kPressureSession) {
  PressureMessage message;
  message.header.session_id = session;
  message.header.tick = tick;
  message.joint_count = 1;
  message.pressure.imposed = {true, true};
  message.pressure.chamber_pressure_bar = {pressure_bar, pressure_bar};
  return message;
}

PressureSource Source() { return {kPressureSession, milliseconds(5), milliseconds(60)}; }

TEST(PressureSource, ImposesNothingUntilItIsAsked) {
  EXPECT_FALSE(Source().Current(0, false).imposed[0]);
  EXPECT_EQ(Source().answers(), 0u);
}

TEST(PressureSource, ActsUntilFaultAfterAndNoLonger) {
  PressureSource source = Source();
  EXPECT_TRUE(source.Take(AskPressure(10, 4.0), 10));
  EXPECT_EQ(source.answers(), 11u);
  EXPECT_EQ(source.Current(10, false).chamber_pressure_bar[0], 4.0);
  EXPECT_TRUE(source.Current(22, false).imposed[0]);   // 60 ms
  EXPECT_FALSE(source.Current(23, false).imposed[0]);  // 65 ms
  EXPECT_FALSE(source.Current(10, false).imposed[1]) << "beyond joint_count";
}

TEST(PressureSource, AStoppedRobotHasNoImposedPressure) {
  PressureSource source = Source();
  ASSERT_TRUE(source.Take(AskPressure(10, 4.0), 10));
  EXPECT_FALSE(source.Current(10, true).imposed[0]);
}

TEST(PressureSource, OtherSessionsTheFutureAndWhatIsNotFiniteDoNotCount) {
  PressureSource source = Source();
  EXPECT_FALSE(source.Take(AskPressure(10, 4.0, kPressureSession + 1), 10));
  EXPECT_FALSE(source.Take(AskPressure(11, 4.0), 10));
  EXPECT_FALSE(source.Current(11, false).imposed[0]);
  EXPECT_TRUE(source.Take(AskPressure(12, NAN), 12));
  EXPECT_FALSE(source.Current(12, false).imposed[0]);
}

}  // namespace
}  // namespace sinew::provider
