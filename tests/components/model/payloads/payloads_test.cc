// Point masses of a model file on the bodies of a chain.
#include "components/model/payloads/payloads.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

namespace sinew::arm {
namespace {

using ::testing::HasSubstr;

// A base of 5 kg and a link of 2 kg with its centre of mass at x = 0.1.
Chain TwoBodies() {
  Chain chain;
  chain.name = "two";
  chain.base.link_name = "torso";
  chain.base.mass_kg = 5.0;
  Body body;
  body.link_name = "leg";
  body.joint_name = "hip";
  body.moves = true;
  body.mass_kg = 2.0;
  body.com_m = {0.1, 0.0, 0.0};
  chain.bodies.push_back(body);
  return chain;
}

actuator::Payload PayloadOn(const std::string& link, double mass_kg,
                            const std::array<double, 3>& position_m) {
  actuator::Payload payload;
  payload.link = link;
  payload.mass_kg = mass_kg;
  payload.position_m = position_m;
  return payload;
}

TEST(WithPayloads, MassFirstMomentsAndInertiaAddUp) {
  const Chain loaded = WithPayloads(
      TwoBodies(), {PayloadOn("torso", 5.0, {0.0, 0.2, 0.0}), PayloadOn("leg", 2.0, {0.3, 0, 0})});
  EXPECT_DOUBLE_EQ(loaded.base.mass_kg, 10.0);
  EXPECT_NEAR(loaded.base.com_m.y(), 0.1, 1e-15);
  EXPECT_DOUBLE_EQ(loaded.bodies[0].mass_kg, 4.0);
  EXPECT_NEAR(loaded.bodies[0].com_m.x(), 0.2, 1e-15);
  // Two points of 2 kg, 0.1 m from their middle each.
  EXPECT_NEAR(loaded.bodies[0].inertia_kg_m2(2, 2), 2.0 * 2.0 * 0.1 * 0.1, 1e-15);
  EXPECT_NEAR(loaded.bodies[0].inertia_kg_m2(0, 0), 0.0, 1e-15);
}

TEST(WithPayloads, NoneChangesNothing) {
  const Chain same = WithPayloads(TwoBodies(), {});
  EXPECT_EQ(same.base.mass_kg, 5.0);
  EXPECT_EQ(same.bodies[0].com_m.x(), 0.1);
}

TEST(WithPayloads, NamesTheLinkThatIsNotThere) {
  const auto error = [](const actuator::Payload& payload) -> std::string {
    try {
      WithPayloads(TwoBodies(), {payload});
    } catch (const std::invalid_argument& thrown) {
      return thrown.what();
    }
    return "no error";
  };
  EXPECT_THAT(error(PayloadOn("arm", 1.0, {0, 0, 0})), HasSubstr("'arm'"));
  EXPECT_THAT(error(PayloadOn("leg", 0.0, {0, 0, 0})), HasSubstr("'leg'"));
  EXPECT_THAT(error(PayloadOn("leg", 1.0, {0, std::nan(""), 0})), HasSubstr("'leg'"));
}

}  // namespace
}  // namespace sinew::arm
