// A URDF of more links than a robot has.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

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

}  // namespace
}  // namespace sinew::arm
