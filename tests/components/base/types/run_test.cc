#include "components/base/types/run.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stdexcept>

namespace sinew::types {
namespace {

using ::testing::HasSubstr;

TEST(Run, IsEmptyAtFirst) {
  const types::Run run;
  EXPECT_EQ(run.size(), 0);
  EXPECT_EQ(run.kind, JointKind::kRevolute);
  for (const Signal signal : AllSignals()) EXPECT_FALSE(run.Has(signal)) << SignalName(signal);
}

TEST(Run, ReturnsTheColumnOfASignal) {
  types::Run run;
  run.time_s = Eigen::Vector3d(0.0, 0.1, 0.25);
  run.signals[Signal::kPosition] = Eigen::Vector3d(1.0, -2.0, 3.0);
  EXPECT_EQ(run.size(), 3);
  EXPECT_TRUE(run.Has(Signal::kPosition));
  EXPECT_FALSE(run.Has(Signal::kVelocity));
  EXPECT_EQ(run.At(Signal::kPosition), Eigen::Vector3d(1.0, -2.0, 3.0));
}

TEST(Run, AMissingSignalIsNamedWithItsRun) {
  types::Run run;
  run.name = "a.csv";
  try {
    (void)run.At(Signal::kMotorCurrent);
    FAIL() << "no exception";
  } catch (const std::invalid_argument& error) {
    EXPECT_THAT(error.what(), HasSubstr("motor_current"));
    EXPECT_THAT(error.what(), HasSubstr("a.csv"));
  }
}

}  // namespace
}  // namespace sinew::types
