// Visual elements of a URDF, and what is refused with its line.
#include "sim/render/file/scene_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>
#include <string>

#include "components/base/config/config.h"
#include "tests/sim/render/biped_squat.h"

namespace sinew::render {
namespace {

using ::testing::HasSubstr;

// Line 7 is the visual; `visual` has no line breaks.
std::string Pendulum(const std::string& visual, const std::string& material = "") {
  return "<robot name='p'>\n" + material +
         "\n<link name='base'/>\n"
         "<joint name='j' type='continuous'><parent link='base'/><child link='rod'/>"
         "<axis xyz='0 1 0'/></joint>\n"
         "<link name='rod'>\n"
         "<inertial><mass value='1'/><inertia ixx='1' iyy='1' izz='1' ixy='0' ixz='0' iyz='0'/>"
         "</inertial>\n" +
         visual + "\n</link>\n</robot>\n";
}

std::string ErrorOf(const std::string& visual, const std::string& material = "") {
  try {
    (void)ParseScene(Pendulum(visual, material), "p.urdf");
  } catch (const UsageError& error) {
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
    return error.what();
  }
  return "no error";
}

TEST(SceneFile, ReadsShapesOriginsAndColours) {
  const Scene scene = ParseScene(
      Pendulum("<visual><origin xyz='0 0 -0.5' rpy='0 1.5707963267948966 0'/><geometry>"
               "<cylinder radius='0.1' length='0.6'/></geometry><material name='red'/></visual>"
               "<visual><geometry><sphere radius='0.2'/></geometry>"
               "<material name='own'><color rgba='0.1 0.2 0.3 1'/></material></visual>"
               "<visual><geometry><mesh filename='rod.stl'/></geometry></visual>",
               "<material name='red'><color rgba='1 0 0 1'/></material>"),
      "p.urdf");
  ASSERT_EQ(scene.visuals.size(), 2u);
  EXPECT_EQ(scene.mesh_count, 1);
  const Visual& rod = scene.visuals[0];
  EXPECT_EQ(rod.body, 0);
  EXPECT_EQ(rod.shape, Shape::kCylinder);
  EXPECT_EQ(rod.size_m, Eigen::Vector3d(0.1, 0.1, 0.6));
  EXPECT_EQ(rod.colour.red, 1.0);
  // Its axis lies along the link's x.
  EXPECT_LT(
      (rod.link_from_visual.linear() * Eigen::Vector3d::UnitZ() - Eigen::Vector3d::UnitX()).norm(),
      1e-12);
  EXPECT_EQ(scene.visuals[1].size_m, Eigen::Vector3d(0.2, 0.2, 0.2));
  EXPECT_EQ(scene.visuals[1].colour.blue, 0.3);
}

TEST(SceneFile, NamesFileAndLineOfABadVisual) {
  const std::string box = "<visual><geometry><box size='";
  EXPECT_THAT(ErrorOf(box + "1 2'/></geometry></visual>"),
              HasSubstr("p.urdf:7: link 'rod': box: size is '1 2', expected 3 numbers"));
  EXPECT_THAT(ErrorOf(box + "1 2 3 4'/></geometry></visual>"), HasSubstr("expected 3 numbers"));
  EXPECT_THAT(ErrorOf(box + "1 nan 3'/></geometry></visual>"), HasSubstr("expected 3 numbers"));
  EXPECT_THAT(ErrorOf(box + "1 0 3'/></geometry></visual>"), HasSubstr("expected m above 0"));
  EXPECT_THAT(ErrorOf("<visual><geometry><sphere radius='-1'/></geometry></visual>"),
              HasSubstr("radius is '-1', expected m above 0"));
  EXPECT_THAT(ErrorOf("<visual><geometry><cylinder radius='1'/></geometry></visual>"),
              HasSubstr("p.urdf:7: link 'rod': cylinder: length is missing"));
  EXPECT_THAT(ErrorOf("<visual><geometry><cone radius='1'/></geometry></visual>"),
              HasSubstr("'cone' is no geometry"));
  EXPECT_THAT(ErrorOf("<visual/>"), HasSubstr("p.urdf:7: link 'rod': visual: has no geometry"));
  EXPECT_THAT(ErrorOf("<visual><geometry/></visual>"), HasSubstr("has no geometry"));
  EXPECT_THAT(ErrorOf("<visual><origin xyz='a b c'/><geometry><sphere radius='1'/></geometry>"
                      "</visual>"),
              HasSubstr("p.urdf:7: link 'rod': origin: xyz is 'a b c', expected 3 numbers"));
  const std::string sphere = "<visual><geometry><sphere radius='1'/></geometry>";
  EXPECT_THAT(ErrorOf(sphere + "<material name='blue'/></visual>"),
              HasSubstr("p.urdf:7: link 'rod': material 'blue' has no color, expected one"));
  EXPECT_THAT(ErrorOf(sphere + "<material/></visual>"),
              HasSubstr("p.urdf:7: link 'rod': material '' has no color, expected one"));
  EXPECT_THAT(ErrorOf(sphere + "</visual>", "<material name='m'/>"),
              HasSubstr("p.urdf:2: material 'm' has no color, expected one"));
  EXPECT_THAT(
      ErrorOf(sphere + "</visual>", "<material name='m'><color rgba='0 0 2 1'/></material>"),
      HasSubstr("p.urdf:2: color: rgba is '0 0 2 1', expected 0 to 1 each"));
}

// The definition at the robot's top level, or in a visual of any link, before or after those that
// have its name alone.
TEST(SceneFile, AMaterialIsThatOfItsNameWhereverItIsDefined) {
  const std::string red = "<material name='red'><color rgba='1 0 0 1'/></material>";
  const std::string sphere = "<visual><geometry><sphere radius='1'/></geometry>";
  const std::string named = sphere + "<material name='red'/></visual>";
  const auto link = [](const std::string& name, const std::string& visuals) {
    return "<link name='" + name + "'>" + visuals + "</link><joint name='f" + name +
           "' type='fixed'><parent link='rod'/><child link='" + name + "'/></joint>";
  };
  const std::string defines = sphere + red + "</visual>";
  for (const auto& [visuals, more] :
       {std::pair{named, red},
        {named, link("a", defines)},
        {named, link("z", named + defines)},
        {defines + named, link("a", named)},
        {named + defines, link("a", named)},
        {named,
         link("z", defines + sphere +
                       "<material name='red'><color rgba='0 1 0 1'/></material></visual>")}}) {
    const Scene scene = ParseScene(Pendulum(visuals, more), "p.urdf");
    int reds = 0;
    for (const Visual& visual : scene.visuals) reds += visual.colour.red == 1.0 ? 1 : 0;
    EXPECT_GE(reds, static_cast<int>(scene.visuals.size()) - 1) << more;
    EXPECT_EQ(scene.visuals[0].colour.green, scene.visuals[0].colour.blue) << more;
  }
  for (const char* plain : {"<material name=''/>",
                            "<material name='t'><texture filename='t.png'/>"
                            "</material>"}) {
    EXPECT_EQ(ParseScene(Pendulum(sphere + plain + "</visual>"), "p.urdf").visuals[0].colour.red,
              Colour{}.red);
  }
}

TEST(SceneFile, ARobotWithoutShapesIsRefused) {
  EXPECT_THAT(ErrorOf(""), HasSubstr("p.urdf: nothing to draw"));
  EXPECT_THAT(ErrorOf("<visual><geometry><mesh filename='rod.stl'/></geometry></visual>"),
              HasSubstr("(1 are meshes)"));
}

TEST(SceneFile, LeavesOtherComplaintsToTheReaderOfBodies) {
  try {
    (void)ParseScene("<robot name='p'>\n<link>\n</robot>", "p.urdf");
    FAIL();
  } catch (const UsageError& error) {
    EXPECT_THAT(error.what(), HasSubstr("p.urdf:3: no valid XML"));
  }
  EXPECT_THROW((void)LoadScene("/no/such/file.urdf"), UsageError);
}

TEST(SceneFile, TheLegsOfTheBipedDifferInColour) {
  const Scene scene = BipedSquat().scene();
  ASSERT_EQ(scene.visuals.size(), 33u);
  int left = 0, right = 0;
  for (const Visual& visual : scene.visuals) {
    if (visual.body < 0) continue;
    const std::string& link = scene.chain.bodies[static_cast<std::size_t>(visual.body)].link_name;
    if (visual.colour.blue > 0.6 && visual.colour.red < 0.4) {
      EXPECT_EQ(link.rfind("left_", 0), 0u) << link;
      ++left;
    }
    if (visual.colour.red > 0.8 && visual.colour.blue < 0.4) {
      EXPECT_EQ(link.rfind("right_", 0), 0u) << link;
      ++right;
    }
  }
  EXPECT_EQ(left, right);
  EXPECT_GE(left, 5);
}

}  // namespace
}  // namespace sinew::render
