// The URDF with the model's values, read back with the project's reader.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
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
  EXPECT_THAT(text, HasSubstr("<visual name=\"lever\">"));
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

// Whatever the limits say here, the written URDF says where other readers see the same.
TEST(Urdf, LimitsHaveTheirMeaningForOtherReaders) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const actuator::RobotModel rig = RigOfBodies();
  struct Case {
    const char *type, *lower, *upper, *mimic;
    const char *written_type, *written_lower, *written_upper;
  };
  for (const Case& c : {Case{"revolute", "0", "0", "", "continuous", "0", "0"},
                        {"continuous", "0", "0", "", "continuous", "0", "0"},
                        {"continuous", "-1", "1", "", "continuous", "-1", "1"},
                        {"prismatic", "0", "0", "", "prismatic", "-1e+16", "1e+16"},
                        {"prismatic", "-1", "1", "", "prismatic", "-1", "1"},
                        {"revolute", "0.5", "0.5", "", "revolute", "0.5", "0.5"},
                        {"revolute", "-1", "1", "", "revolute", "-1", "1"}}) {
    std::string urdf = UrdfText(rig);
    urdf.insert(
        urdf.rfind("</robot>"),
        "<link name=\"tip\"><inertial><mass value=\"1\"/><inertia ixx=\"1\" ixy=\"0\" ixz=\"0\" "
        "iyy=\"1\" iyz=\"0\" izz=\"1\"/></inertial></link><joint name=\"k\" type=\"" +
            std::string(c.type) + "\"><parent link=\"link\"/><child link=\"tip\"/><limit lower=\"" +
            c.lower + "\" upper=\"" + c.upper + "\" effort=\"0\" velocity=\"1\"/></joint>");
    const arm::Chain before = arm::ParseUrdf(urdf, "r.urdf");
    const std::string text = WriteUrdf(Describe(rig, before), urdf, {});
    EXPECT_THAT(text, HasSubstr(std::string("<joint name=\"k\" type=\"") + c.written_type + "\">"));
    EXPECT_THAT(text, HasSubstr(std::string("<limit lower=\"") + c.written_lower + "\" upper=\"" +
                                c.written_upper + "\""));
    const arm::Body& of = before.bodies.back();
    const arm::Body after = arm::ParseUrdf(text, "written.urdf").bodies.back();
    for (const auto& [was, is] : {std::pair{of.lower, after.lower}, {of.upper, after.upper}}) {
      EXPECT_EQ(std::abs(is) == 1e16 ? std::copysign(kInfinity, is) : is, was) << c.type << c.lower;
    }
  }
}

TEST(Urdf, HasTheMaterialsThatItRefersToAtItsTopLevel) {
  const actuator::RobotModel rig = RigRobot();
  std::string urdf = UrdfText(rig);
  const std::string box =
      "<visual><geometry><box size=\"1 1 1\"/></geometry><material name=\"own\"";
  urdf.insert(
      urdf.rfind("</robot>"),
      "<link name=\"a\">" + box + "/></visual>" + box +
          "><color rgba=\"1 0 0 1\"/></material></visual></link><joint name=\"fa\" type=\"fixed\">"
          "<parent link=\"link\"/><child link=\"a\"/></joint>");
  const std::string text = WriteUrdf(Described(rig), urdf, {});
  EXPECT_LT(text.find("<material name=\"own\">"), text.find("<link"));
}

TEST(Urdf, ThatIsNoXmlOrLacksAJointIsRefused) {
  const DescribedRobot rig = Described(RigRobot());
  EXPECT_THROW(WriteUrdf(rig, "<robot", {}), UsageError);
  EXPECT_THROW(WriteUrdf(rig, "<robot name=\"x\"><link name=\"link\"/></robot>", {}),
               std::invalid_argument);
}

}  // namespace
}  // namespace sinew::export_model
