// A URDF of more links than a robot has.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "components/base/config/config.h"
#include "components/bodies/links/file/urdf_file.h"

namespace sinew::arm {
namespace {

// Links one after the other, so that a visit of the last one is the deepest.
std::string ChainOf(int links) {
  std::string xml = "<robot name='r'>\n";
  for (int i = 0; i < links; ++i) {
    const std::string name = std::to_string(i);
    xml += "<link name='" + name +
           "'><inertial><mass value='1'/><inertia ixx='1' iyy='1' izz='1' ixy='0' ixz='0' "
           "iyz='0'/></inertial></link>\n";
    if (i == 0) continue;
    xml += "<joint name='j" + name + "' type='" + (i == 1 ? "continuous" : "fixed") +
           "'><parent link='" + std::to_string(i - 1) + "'/><child link='" + name + "'/></joint>";
  }
  return xml + "</robot>\n";
}

TEST(UrdfBounds, AsManyLinksAsAllowedAreRead) {
  EXPECT_EQ(ParseUrdf(ChainOf(kMostLinks), "f.urdf").bodies.size(),
            static_cast<std::size_t>(kMostLinks) - 1);
}

TEST(UrdfBounds, MoreAreAnErrorWithALine) {
  try {
    ParseUrdf(ChainOf(kMostLinks + 1), "f.urdf");
    FAIL() << "no error";
  } catch (const UsageError& error) {
    EXPECT_STREQ(error.what(), "f.urdf:1002: more than 1000 links, expected fewer");
  }
}

std::string OneJoint(const std::string& limit, const std::string& more = "") {
  const std::string inertial =
      "<inertial><mass value='1'/><inertia ixx='1' iyy='1' izz='1' ixy='0' ixz='0' iyz='0'/>"
      "</inertial>";
  return "<robot name='r'><link name='base'/>\n<link name='arm'>" + inertial +
         "</link>\n<joint name='j' type='revolute'><parent link='base'/><child link='arm'/>" +
         limit + "</joint>\n" + more + "</robot>\n";
}

std::string UrdfError(const std::string& xml) {
  try {
    ParseUrdf(xml, "f.urdf");
  } catch (const UsageError& error) {
    return error.what();
  }
  return "no error";
}

TEST(UrdfLimits, EqualOnesLockTheJointAndZerosStateNone) {
  const auto body = [](const std::string& limits) {
    return ParseUrdf(OneJoint("<limit " + limits + " effort='1' velocity='1'/>"), "f.urdf")
        .bodies.at(0);
  };
  EXPECT_EQ(body("lower='0.5' upper='0.5'").lower, 0.5);
  EXPECT_EQ(body("lower='0.5' upper='0.5'").upper, 0.5);
  EXPECT_EQ(body("lower='-1' upper='0'").upper, 0.0);
  for (const char* none : {"", "lower='0' upper='0'"}) {
    EXPECT_TRUE(std::isinf(body(none).lower)) << none;
    EXPECT_TRUE(std::isinf(body(none).upper)) << none;
  }
}

TEST(UrdfXacro, AnElementThatWasNotExpandedIsRefusedAtAnyDepth) {
  const std::string limit = "<limit lower='-1' upper='1' effort='1' velocity='1'/>";
  EXPECT_EQ(UrdfError(OneJoint(limit)), "no error");
  EXPECT_EQ(UrdfError(OneJoint(limit, "<xacro:if value='true'><link name='x'/></xacro:if>")),
            "f.urdf:4: 'xacro:if': expand it with xacro first, expected a URDF");
  EXPECT_EQ(UrdfError(OneJoint(limit + "<xacro:limit/>")),
            "f.urdf:3: 'xacro:limit': expand it with xacro first, expected a URDF");
}

}  // namespace
}  // namespace sinew::arm
