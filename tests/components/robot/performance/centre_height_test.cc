// The height of a centre of mass against chains whose heights are known by hand.
#include "components/robot/performance/centre_height.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "tests/support/allocations.h"

namespace sinew::performance {
namespace {

constexpr double kHeightRounding_m = 1e-15;

// A base of 1 kg; below it, at y axes, a thigh of 2 kg and a shank of 1 kg, both 0.5 m long with
// the mass in the middle; a foot without mass at the end.
arm::Chain HangingLeg() {
  arm::Chain chain;
  chain.base = {.link_name = "base", .mass_kg = 1.0, .com_m = Eigen::Vector3d(0.0, 0.0, 0.1)};
  const auto add = [&chain](const char* link, const char* joint, int parent, double below_m,
                            double mass_kg, bool moves) {
    arm::Body body;
    body.link_name = link;
    body.joint_name = joint;
    body.parent = parent;
    body.moves = moves;
    body.axis = Eigen::Vector3d::UnitY();
    body.parent_from_joint.translation().z() = -below_m;
    body.mass_kg = mass_kg;
    body.com_m = Eigen::Vector3d(0.0, 0.0, -0.25);
    chain.bodies.push_back(body);
  };
  add("thigh", "hip", -1, 0.0, 2.0, true);
  add("shank", "knee", 0, 0.5, 1.0, true);
  add("foot", "sole", 1, 0.5, 0.0, false);
  return chain;
}

// Of the four masses by hand: hip angle a, knee angle b.
double HeightByHand(double a, double b, bool on_foot) {
  const double knee = -0.5 * std::cos(a), foot = knee - 0.5 * std::cos(a + b);
  const double moment = 1.0 * 0.1 + 2.0 * 0.5 * knee + 1.0 * 0.5 * (knee + foot);
  return moment / 4.0 - (on_foot ? foot : 0.0);
}

TEST(CentreHeight, IsThatOfTheMassesAboveTheFoot) {
  CentreHeight standing(HangingLeg(), {"hip", "knee"}, {"foot"});
  EXPECT_EQ(standing.mass_kg(), 4.0);
  CentreHeight hanging(HangingLeg(), {"hip", "knee"}, {});
  for (const auto& [a, b] : {std::pair{0.0, 0.0}, {-0.7, 1.4}, {0.3, -0.2}, {1.2, 2.0}}) {
    EXPECT_NEAR(standing.Of(std::array{a, b}), HeightByHand(a, b, true), kHeightRounding_m);
    EXPECT_NEAR(hanging.Of(std::array{a, b}), HeightByHand(a, b, false), kHeightRounding_m);
  }
}

TEST(CentreHeight, TakesTheOrderOfTheNamesAndLeavesOthersAtZero) {
  CentreHeight swapped(HangingLeg(), {"knee", "hip"}, {"foot"});
  EXPECT_NEAR(swapped.Of(std::array{1.4, -0.7}), HeightByHand(-0.7, 1.4, true), kHeightRounding_m);
  CentreHeight knee(HangingLeg(), {"knee"}, {"foot"});
  EXPECT_NEAR(knee.Of(std::array{0.9}), HeightByHand(0.0, 0.9, true), kHeightRounding_m);
}

TEST(CentreHeight, FollowsAPrismaticJoint) {
  arm::Chain chain = HangingLeg();
  chain.bodies[0].prismatic = true;
  chain.bodies[0].axis = Eigen::Vector3d::UnitZ();
  CentreHeight lifted(chain, {"hip"}, {});
  // Three of the four kg move.
  EXPECT_NEAR(lifted.Of(std::array{0.2}) - lifted.Of(std::array{0.0}), 0.2 * 3.0 / 4.0,
              kHeightRounding_m);
}

TEST(CentreHeight, OfAnUnknownAngleIsUnknown) {
  CentreHeight leg(HangingLeg(), {"hip", "knee"}, {"foot"});
  EXPECT_TRUE(std::isnan(leg.Of(std::array{0.1})));
  EXPECT_TRUE(std::isnan(leg.Of(std::array{0.1, std::nan("")})));
  EXPECT_TRUE(std::isnan(leg.Of(std::array{std::numeric_limits<double>::infinity(), 0.1})));
  EXPECT_NEAR(leg.Of(std::array{0.0, 0.0}), HeightByHand(0.0, 0.0, true), kHeightRounding_m);
}

TEST(CentreHeight, RefusesWhatIsNotThere) {
  EXPECT_THROW(CentreHeight(HangingLeg(), {"ankle"}, {}), std::invalid_argument);
  EXPECT_THROW(CentreHeight(HangingLeg(), {"sole"}, {}), std::invalid_argument);  // fixed
  EXPECT_THROW(CentreHeight(HangingLeg(), {"hip"}, {"toe"}), std::invalid_argument);
  arm::Chain light = HangingLeg();
  light.base.mass_kg = 0.0;
  for (arm::Body& body : light.bodies) body.mass_kg = 0.0;
  EXPECT_THROW(CentreHeight(light, {"hip"}, {}), std::invalid_argument);
}

TEST(CentreHeight, AllocatesNothingInAStep) {
  CentreHeight leg(HangingLeg(), {"hip", "knee"}, {"foot"});
  double sum_m = 0.0;
  const long before = test::Allocations();
  for (int i = 0; i < 1000; ++i) sum_m += leg.Of(std::array{1e-3 * i, -2e-3 * i});
  EXPECT_EQ(test::Allocations(), before);
  EXPECT_TRUE(std::isfinite(sum_m));
}

}  // namespace
}  // namespace sinew::performance
