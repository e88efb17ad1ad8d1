// Positions and another generator's reference come from the wire: what is not finite, or so far
// away that the way there is not, is never published.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <memory>

#include "components/robot/reference/standby.h"

namespace sinew::reference {
namespace {

constexpr double kHuge_rad = 1.7e308;

class UntrustedReference : public ::testing::Test {
 protected:
  RobotReferenceInput At(std::uint64_t tick) {
    RobotReferenceInput input;
    input.session_id = 5;
    input.tick = tick;
    input.period_s = 1.0 / 240.0;
    input.may_move = true;
    input.joint_count = 1;
    input.position_rad = measured_rad_;
    input.valid = valid_;
    return input;
  }
  static RobotReferenceConfig SoftSine() {
    RobotReferenceConfig config;
    GeneratorConfig joint;
    joint.trajectory =
        std::make_shared<Sine>(SineConfig{.amplitude_rad = 0.5, .frequency_Hz = 0.4});
    joint.soft_start_s = 2.0;
    config.joints.push_back(joint);
    return config;
  }
  static RobotReferenceOutput Asking(const Point& point) {
    RobotReferenceOutput owner;
    owner.joint_count = 1;
    owner.idle = false;
    owner.joint[0] = point;
    return owner;
  }

  std::array<double, 1> measured_rad_{0.1};
  std::array<bool, 1> valid_{true};
  Standby standby_{SoftSine()};
};

TEST_F(UntrustedReference, AnIdleReferenceRepeatsOnlyFinitePositions) {
  measured_rad_[0] = std::numeric_limits<double>::infinity();
  RobotReferenceInput input = At(0);
  input.may_move = false;
  EXPECT_TRUE(AllFinite(standby_.Step(input, false)));
}

TEST_F(UntrustedReference, AStartFromTooFarAwayEndsIdleUntilItIsAskedAnew) {
  measured_rad_[0] = kHuge_rad;
  std::uint64_t tick = 0;
  bool ended = false;
  for (; tick < 10'000 && !ended; ++tick) {
    const RobotReferenceOutput output = standby_.Step(At(tick), false);
    ASSERT_TRUE(AllFinite(output)) << tick;
    ended = output.idle && output.stale;
  }
  ASSERT_TRUE(ended);
  measured_rad_[0] = 0.1;
  EXPECT_TRUE(standby_.Step(At(tick), false).idle);
  RobotReferenceInput asked = At(++tick);
  asked.operator_start = true;
  EXPECT_FALSE(standby_.Step(asked, false).idle);
}

TEST_F(UntrustedReference, AnOwnersReferenceThatIsNotFiniteIsNotFollowed) {
  const Point good{0.3, 1.2, -2.0};
  standby_.Follow(10, Asking(good));
  standby_.Follow(11, Asking({std::numeric_limits<double>::quiet_NaN(), 0.0, 0.0}));
  EXPECT_EQ(standby_.Step(At(10), true).joint[0].position_rad, good.position_rad);
  standby_.Follow(12, Asking({kHuge_rad, kHuge_rad, kHuge_rad}));
  EXPECT_TRUE(AllFinite(standby_.Step(At(12 + 1000), true)));
  for (std::uint64_t tick = 1013; tick < 2000; ++tick) {  // and then it is heard itself
    ASSERT_TRUE(AllFinite(standby_.Step(At(tick), false))) << tick;
  }
}

}  // namespace
}  // namespace sinew::reference
