#include "components/bodies/leg/geometry.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stdexcept>

namespace sinew::leg {
namespace {

using ::testing::HasSubstr;

void Add(arm::Chain& chain, const std::string& joint, const Eigen::Vector3d& offset_m,
         const Eigen::Vector3d& axis, bool moves = true) {
  arm::Body body;
  body.joint_name = joint;
  body.link_name = joint + "_link";
  body.parent = static_cast<int>(chain.bodies.size()) - 1;
  body.moves = moves;
  body.parent_from_joint.translation() = offset_m;
  body.axis = axis;
  chain.bodies.push_back(body);
}

// A leg whose hip frames lie apart on their axes, and whose pelvis is not the root itself.
arm::Chain Leg() {
  const Eigen::Vector3d x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);
  arm::Chain chain;
  Add(chain, "pelvis", {0, 0, 0.1}, x, false);
  Add(chain, "left_hip_yaw", {0.01, 0.075, 0.05}, z);
  Add(chain, "left_hip_roll", {-0.06, 0, -0.15}, x);
  Add(chain, "left_hip_pitch", {0.06, 0.03, 0}, y);
  Add(chain, "left_knee", {0, 0.02, -0.278}, y);
  Add(chain, "left_ankle_pitch", {0, 0, -0.26}, y);
  Add(chain, "left_ankle_roll", {0.02, -0.05, -0.104}, x);
  Add(chain, "sole", {-0.02, 0.001, -0.134}, x, false);
  return chain;
}

std::string ErrorOf(const arm::Chain& chain, const std::string& sole = "sole_link") {
  try {
    static_cast<void>(GeometryOf(chain, NamesOfSide("left"), sole));
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "no error";
}

TEST(LegGeometry, IsReadFromTheBodies) {
  const LegGeometry g = GeometryOf(Leg(), NamesOfSide("left"), "sole_link");
  EXPECT_LT((g.hip_in_pelvis_m - Eigen::Vector3d(0.01, 0.075, 0.0)).norm(), 1e-12);
  EXPECT_NEAR(g.thigh_m, 0.278, 1e-12);
  EXPECT_NEAR(g.shank_m, 0.260, 1e-12);
  EXPECT_NEAR(g.ankle_offset_m, 0.104, 1e-12);
  EXPECT_LT((g.sole_in_ankle_m - Eigen::Vector3d(0.0, 0.001, -0.134)).norm(), 1e-12);
}

TEST(LegGeometry, RefusesAxesOfAnotherKindByName) {
  for (int i = 1; i <= kLegJoints; ++i) {
    arm::Chain chain = Leg();
    arm::Body& body = chain.bodies[static_cast<std::size_t>(i)];
    body.axis = -body.axis;
    EXPECT_THAT(ErrorOf(chain), HasSubstr("joint '" + body.joint_name + "' turns about"));
  }
}

TEST(LegGeometry, RefusesAHipWhoseAxesDoNotMeet) {
  arm::Chain chain = Leg();
  chain.bodies[2].parent_from_joint.translation().y() += 0.004;
  EXPECT_THAT(ErrorOf(chain), HasSubstr("joint 'left_hip_roll': its axis misses the hip centre"));
  EXPECT_THAT(ErrorOf(chain), HasSubstr("in y by 0.004 m"));
  chain = Leg();
  chain.bodies[3].parent_from_joint.translation().z() -= 0.004;
  EXPECT_THAT(ErrorOf(chain), HasSubstr("joint 'left_hip_pitch': its axis misses the hip centre"));
}

TEST(LegGeometry, RefusesALegThatIsNotStraightBelowTheHip) {
  arm::Chain chain = Leg();
  chain.bodies[4].parent_from_joint.translation().x() = 0.01;
  EXPECT_THAT(ErrorOf(chain), HasSubstr("joint 'left_knee': its axis is not straight below"));
  chain = Leg();
  chain.bodies[6].parent_from_joint.translation().y() = 0.0;
  EXPECT_THAT(ErrorOf(chain), HasSubstr("joint 'left_ankle_roll': its axis does not cross"));
  chain = Leg();
  chain.bodies[5].parent_from_joint.translation().z() = 0.26;
  EXPECT_THAT(ErrorOf(chain), HasSubstr("joint 'left_ankle_pitch': its distance below"));
}

TEST(LegGeometry, RefusesAMissingAPrismaticOrAMisplacedJoint) {
  arm::Chain chain = Leg();
  chain.bodies[4].joint_name = "knees";
  EXPECT_THAT(ErrorOf(chain), HasSubstr("joint 'left_knee': no moving joint"));
  chain = Leg();
  chain.bodies[4].prismatic = true;
  EXPECT_THAT(ErrorOf(chain), HasSubstr("joint 'left_knee' is prismatic"));
  chain = Leg();
  chain.bodies[4].parent = 1;
  EXPECT_THAT(ErrorOf(chain), HasSubstr("joint 'left_knee' does not follow"));
}

TEST(LegGeometry, RefusesASoleThatIsNotTheFoots) {
  EXPECT_THAT(ErrorOf(Leg(), "shoe"), HasSubstr("link 'shoe': no link of this name"));
  EXPECT_THAT(ErrorOf(Leg(), "left_knee_link"), HasSubstr("is not fixed to the link of"));
  arm::Chain chain = Leg();
  chain.bodies[7].parent_from_joint.rotate(Eigen::AngleAxisd(0.1, Eigen::Vector3d::UnitX()));
  EXPECT_THAT(ErrorOf(chain), HasSubstr("not parallel"));
}

}  // namespace
}  // namespace sinew::leg
