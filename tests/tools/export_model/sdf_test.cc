// libsdformat reads what is written, and has the values of the model file.
#include <gtest/gtest.h>

#include <cmath>
#include <sdf/sdf.hh>
#include <string>

#include "tests/tools/export_model/exported.h"

namespace sinew::export_model {
namespace {

const sdf::Model* LoadSdf(const std::string& text, sdf::Root* root) {
  for (const sdf::Error& error : root->LoadSdfString(text)) {
    ADD_FAILURE() << error.Message() << "\n" << text;
  }
  EXPECT_NE(root->Model(), nullptr);
  return root->Model();
}

TEST(Sdf, OfTheRigHasTheValuesOfTheModelFile) {
  const actuator::RobotModel rig = RigRobot();
  const DescribedRobot described = Described(rig);
  sdf::Root root;
  const sdf::Model* model = LoadSdf(WriteSdf(described, {"a remark"}), &root);
  ASSERT_NE(model, nullptr);
  const sdf::Joint* joint = model->JointByName("joint");
  ASSERT_NE(joint, nullptr);
  EXPECT_EQ(joint->Type(), sdf::JointType::REVOLUTE);
  const sdf::JointAxis& axis = *joint->Axis(0);
  EXPECT_EQ(axis.Damping(), rig.joints[0].Parameter("motor_viscous", "viscous"));
  EXPECT_EQ(axis.Friction(), rig.joints[0].Parameter("coulomb", "coulomb"));
  EXPECT_NEAR(axis.Effort(), 0.77 * 100.0 * 0.398, 1e-12);
  EXPECT_EQ(axis.Lower(), -2.2);
  EXPECT_EQ(axis.Upper(), 2.2);
  const auto& inertial = model->LinkByName("link")->Inertial();
  const arm::Body& body = described.links.chain.bodies.front();
  EXPECT_DOUBLE_EQ(inertial.MassMatrix().Mass(), body.mass_kg);
  EXPECT_DOUBLE_EQ(inertial.MassMatrix().Iyy(), body.inertia_kg_m2(1, 1));
  EXPECT_DOUBLE_EQ(inertial.Pose().Pos().X(), body.com_m.x());
}

// Read as text: libsdformat knows mimic from version 14 on.
TEST(Sdf, AJointThatMimicsAnotherIsThatOfVersion111) {
  const actuator::RobotModel rig = RigOfBodies();
  const std::string text = WriteSdf(Describe(rig, RigWithFinger(rig)), {});
  EXPECT_NE(text.find("<sdf version=\"1.11\">"), std::string::npos);
  EXPECT_NE(text.find("<mimic joint=\"joint\"><multiplier>-0.5</multiplier><offset>0.25</offset>"
                      "<reference>0</reference></mimic>"),
            std::string::npos)
      << text;
  EXPECT_NE(WriteSdf(Described(rig), {}).find("<sdf version=\"1.9\">"), std::string::npos);
}

TEST(Sdf, OfTheBipedPlacesItsLinksWhereTheUrdfDoes) {
  const actuator::RobotModel biped = LoadedBiped();
  const DescribedRobot described = Described(biped);
  sdf::Root root;
  const sdf::Model* model = LoadSdf(WriteSdf(described, {}), &root);
  ASSERT_NE(model, nullptr);
  EXPECT_EQ(model->LinkCount(), described.links.chain.bodies.size() + 1);
  std::vector<Eigen::Isometry3d> frames;
  for (const arm::Body& body : described.links.chain.bodies) {
    const Eigen::Isometry3d parent = body.parent < 0
                                         ? Eigen::Isometry3d::Identity()
                                         : frames[static_cast<std::size_t>(body.parent)];
    frames.push_back(parent * body.parent_from_joint);
    ignition::math::Pose3d pose;
    ASSERT_TRUE(
        model->LinkByName(body.link_name)->SemanticPose().Resolve(pose, "__model__").empty());
    const Eigen::Vector3d place = frames.back().translation();
    EXPECT_NEAR(pose.Pos().X(), place.x(), 1e-12) << body.link_name;
    EXPECT_NEAR(pose.Pos().Y(), place.y(), 1e-12) << body.link_name;
    EXPECT_NEAR(pose.Pos().Z(), place.z(), 1e-12) << body.link_name;
    const Eigen::Quaterniond rotation(frames.back().linear());
    const double cosine = rotation.w() * pose.Rot().W() + rotation.x() * pose.Rot().X() +
                          rotation.y() * pose.Rot().Y() + rotation.z() * pose.Rot().Z();
    EXPECT_NEAR(std::abs(cosine), 1.0, 1e-12) << body.link_name;
  }
  for (const std::string& link : biped.floating_base->force_links) {
    EXPECT_NE(model->FrameByName(link), nullptr) << link;
  }
  // A passive joint of the URDF is a spring.
  const std::size_t toe_body =
      static_cast<std::size_t>(arm::FindJoint(described.links.chain, "left_toe_passive"));
  const arm::Passive& passive = *described.links.chain.bodies.at(toe_body).passive;
  const sdf::Joint* toe = model->JointByName("left_toe_passive");
  ASSERT_NE(toe, nullptr);
  EXPECT_EQ(toe->Axis(0)->SpringStiffness(), passive.stiffness_Nm_rad);
  EXPECT_EQ(toe->Axis(0)->Damping(), passive.damping_Nms_rad);
}

}  // namespace
}  // namespace sinew::export_model
