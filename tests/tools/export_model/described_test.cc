// What becomes of the terms of a model file.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stdexcept>

#include "tests/tools/export_model/exported.h"
#include "tools/export_model/described_robot.h"
#include "tools/export_model/write_model.h"

namespace sinew::export_model {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::vector<std::string> NamesOf(const std::vector<Dropped>& dropped) {
  std::vector<std::string> names;
  for (const Dropped& part : dropped) names.push_back(part.effect);
  return names;
}

TEST(Describe, AJointThatMimicsAnotherMovesWithItAndHasNoModel) {
  actuator::RobotModel rig = RigOfBodies();
  const DescribedRobot described = Describe(rig, RigWithFinger(rig));
  EXPECT_EQ(described.joints.size(), 1u);
  ASSERT_EQ(described.links.chain.bodies.size(), 2u);
  const auto refuses = [](const actuator::RobotModel& robot, const std::string& expected) {
    try {
      Describe(robot, RigWithFinger(robot));
      FAIL() << expected;
    } catch (const std::invalid_argument& error) {
      EXPECT_THAT(error.what(), HasSubstr(expected));
    }
  };
  refuses(RigRobot(), "joint 'joint': inertia and gravity as terms need a joint");
  rig.joints[0].name = "bend";
  refuses(rig,
          "joint 'bend' mimics 'joint' in the URDF and moves with it, expected no model of it");
}

TEST(Describe, TheInertiaOfTheBaseIsSaidOrNeeded) {
  actuator::RobotModel rig = RigOfBodies();
  for (const double base_kg : {0.0, 7.5}) {
    const DescribedRobot robot = Describe(rig, RigWithFinger(rig, base_kg));
    for (const Format format : {Format::kMjcf, Format::kSdf, Format::kUrdf}) {
      std::string all;
      for (const std::string& remark :
           MakeRemarks(format, rig, robot.links.chain.base, "model.yaml", {}, {}, "")) {
        all += remark;
      }
      const bool said = all.find("mass 7.5 kg and inertia of the base link") != std::string::npos;
      EXPECT_EQ(said, base_kg > 0.0 && format != Format::kUrdf) << all;
    }
  }
  rig.floating_base.emplace();
  EXPECT_NO_THROW(Describe(rig, RigWithFinger(rig, 7.5)));
  EXPECT_THROW(Describe(rig, RigWithFinger(rig, 0.0)), std::invalid_argument);
}

TEST(DroppedBy, EachFormatLeavesOutWhatItHasNoElementFor) {
  const actuator::RobotModel rig = RigRobot();
  EXPECT_THAT(NamesOf(DroppedBy(Format::kMjcf, rig)),
              ElementsAre("pneumatic_torque", "pneumatic_stiffness", "backlash"));
  for (const Format format : {Format::kUrdf, Format::kSdf}) {
    EXPECT_THAT(NamesOf(DroppedBy(format, rig)), ElementsAre("rotor_inertia", "pneumatic_torque",
                                                             "pneumatic_stiffness", "backlash"));
  }
  EXPECT_EQ(DroppedBy(Format::kMjcf, rig)[0].parameters, "pneumatic_torque_Nm_bar = 0.3587");
}

TEST(DroppedBy, EveryEffectOfTheMotionIsCarriedOrListed) {
  actuator::RobotModel rig = RigRobot();
  for (const std::string& name : effects::EffectNames()) {
    const actuator::Term term = actuator::MakeTerm(name, rig.joints[0].constants);
    for (const Format format : {Format::kMjcf, Format::kUrdf, Format::kSdf}) {
      actuator::RobotModel one = rig;
      one.joints[0].terms = {term};
      one.joints[0].backlash_rad = 0.0;
      EXPECT_EQ(DroppedBy(format, one).empty(), Carries(format, PlaceOf(term))) << name;
    }
  }
  actuator::RobotModel spring = rig;
  spring.joints[0].terms = {actuator::MakeTerm("spring", rig.joints[0].constants)};
  spring.joints[0].backlash_rad = 0.0;
  EXPECT_TRUE(DroppedBy(Format::kSdf, spring).empty());
  EXPECT_EQ(DroppedBy(Format::kUrdf, spring).size(), 1u) << "URDF has no spring";
}

TEST(Without, TakesOutOneTermAndThePlayWithTheRotor) {
  const actuator::JointModel joint = RigRobot().joints[0];
  const actuator::JointModel frictionless = Without(joint, "coulomb");
  EXPECT_EQ(frictionless.terms.size(), joint.terms.size() - 1);
  EXPECT_EQ(frictionless.Find("coulomb"), -1);
  EXPECT_EQ(frictionless.backlash_rad, joint.backlash_rad);
  const actuator::JointModel rotorless = Without(joint, "rotor_inertia");
  EXPECT_EQ(rotorless.Find("rotor_inertia"), -1);
  EXPECT_EQ(rotorless.Find("free_play"), -1);
  EXPECT_EQ(rotorless.backlash_rad, 0.0);
}

TEST(Describe, ScalesTheBodyToInertiaAndWeightOfTheModel) {
  actuator::RobotModel rig = RigRobot();
  actuator::JointModel& joint = rig.joints[0];
  joint.terms[static_cast<std::size_t>(joint.Find("link_inertia"))].linear[0].value = 0.02;
  joint.terms[static_cast<std::size_t>(joint.Find("gravity"))].linear[0].value = 0.9;
  const DescribedRobot robot = Described(rig);
  const arm::Body& body = robot.links.chain.bodies.front();
  const double lever = body.com_m.norm();
  EXPECT_NEAR(body.mass_kg * 9.81 * lever, 0.9, 1e-12);
  EXPECT_NEAR(body.inertia_kg_m2(1, 1) + body.mass_kg * lever * lever, 0.02, 1e-12);
  ASSERT_EQ(robot.changed.count("link"), 1u);
  EXPECT_EQ(robot.changed.at("link")->mass_kg, body.mass_kg);
}

TEST(Describe, RefusesWhatTheBodiesCannotBe) {
  const auto reason = [](const actuator::RobotModel& robot) -> std::string {
    try {
      Described(robot);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "accepted";
  };
  actuator::RobotModel rig = RigRobot();
  rig.joints[0].name = "elbow";
  EXPECT_THAT(reason(rig), HasSubstr("joint 'elbow' is not in the URDF"));
  rig = RigRobot();
  rig.joints[0].terms[static_cast<std::size_t>(rig.joints[0].Find("coulomb"))].linear[0].value =
      -0.1;
  EXPECT_THAT(reason(rig), HasSubstr("dry friction -0.1, expected at least 0"));
  rig = RigRobot();
  rig.joints[0].terms[static_cast<std::size_t>(rig.joints[0].Find("gravity"))].linear[0].value =
      -0.1;
  EXPECT_THAT(reason(rig), HasSubstr("is not above 0"));
  actuator::RobotModel biped = LoadedBiped();
  biped.payloads[0].link = "tail";
  EXPECT_THAT(reason(biped), HasSubstr("tail"));
  biped = LoadedBiped();
  biped.joints[0].terms.push_back(actuator::MakeTerm("link_inertia", biped.joints[0].constants));
  EXPECT_THAT(reason(biped), HasSubstr("fixed base"));
}

}  // namespace
}  // namespace sinew::export_model
