// The URDF with the model's values, read back with the project's reader.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stdexcept>
#include <string>

#include "components/base/config/config.h"
#include "components/model/payloads/payloads.h"
#include "tests/tools/export_model/exported.h"

namespace sinew::export_model {
namespace {

using ::testing::HasSubstr;

TEST(Urdf, OfTheRigHasDynamicsLimitAndBodyAndKeepsItsShapes) {
  actuator::RobotModel rig = RigRobot();
  actuator::JointModel& joint = rig.joints[0];
  joint.terms[static_cast<std::size_t>(joint.Find("gravity"))].linear[0].value = 0.9;
  const std::string text = WriteUrdf(Described(rig), UrdfText(rig), {"a remark"});
  EXPECT_THAT(text, HasSubstr("<!-- a remark -->"));
  EXPECT_THAT(text, HasSubstr("<dynamics damping=\"0.31\" friction=\"0.22\" />"));
  EXPECT_THAT(text, HasSubstr("<box size=\"0.3 0.03 0.03\" />"));
  const arm::Chain chain = arm::ParseUrdf(text, "written.urdf");
  const arm::Body& body = chain.bodies.front();
  EXPECT_NEAR(body.effort, 0.77 * 100.0 * 0.398, 1e-12);
  EXPECT_NEAR(body.mass_kg * 9.81 * body.com_m.x(), 0.9, 1e-12);
  EXPECT_NEAR(body.inertia_kg_m2(1, 1) + body.mass_kg * body.com_m.squaredNorm(), 0.0132, 1e-12);
}

TEST(Urdf, OfTheBipedHasThePayloadInItsLinkAndAllElseAsItWas) {
  const actuator::RobotModel biped = LoadedBiped();
  const std::string text = WriteUrdf(Described(biped), UrdfText(biped), {});
  const arm::Chain written = arm::ParseUrdf(text, "written.urdf");
  const arm::Chain expected = arm::WithPayloads(UrdfChain(biped), biped.payloads);
  ASSERT_EQ(written.bodies.size(), expected.bodies.size());
  for (std::size_t i = 0; i < written.bodies.size(); ++i) {
    const arm::Body& a = written.bodies[i];
    const arm::Body& b = expected.bodies[i];
    EXPECT_EQ(a.link_name, b.link_name);
    EXPECT_NEAR(a.mass_kg, b.mass_kg, 1e-12) << a.link_name;
    EXPECT_LT((a.com_m - b.com_m).norm(), 1e-12) << a.link_name;
    EXPECT_LT((a.inertia_kg_m2 - b.inertia_kg_m2).norm(), 1e-12) << a.link_name;
  }
  EXPECT_THAT(text, HasSubstr("<passive joint=\"left_toe_passive\""));
}

TEST(Urdf, ThatIsNoXmlOrLacksAJointIsRefused) {
  const DescribedRobot rig = Described(RigRobot());
  EXPECT_THROW(WriteUrdf(rig, "<robot", {}), UsageError);
  EXPECT_THROW(WriteUrdf(rig, "<robot name=\"x\"><link name=\"link\"/></robot>", {}),
               std::invalid_argument);
}

}  // namespace
}  // namespace sinew::export_model
