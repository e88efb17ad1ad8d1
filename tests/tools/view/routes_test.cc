// What is answered to which request, without sockets: the page's files, the robot, commands.
#include "tools/view/routes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <spdlog/sinks/ostream_sink.h>
#include <spdlog/spdlog.h>

#include <fstream>
#include <memory>
#include <sstream>

#include "components/base/config/config.h"
#include "tests/support/temporary_folder.h"
#include "tools/view/view_config.h"

namespace sinew::live {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

const std::filesystem::path kViewRobotsFolder = SINEW_SOURCE_DIR "/robots";

HttpRequest Get(const std::string& path) {
  HttpRequest request;
  request.method = "GET";
  request.path = path;
  return request;
}

HttpRequest Post(const std::string& path, const std::string& why_no_command = "") {
  HttpRequest request = Get(path);
  request.method = "POST";
  request.why_no_command = why_no_command;
  return request;
}

TEST(ViewRoutes, ThePageIsServedWithItsTokenAndNothingElseIs) {
  const testing::TemporaryFolder folder;
  std::filesystem::create_directory(folder.path() / "vendor");
  std::ofstream(folder.path() / "index.html") << "<meta content=\"@TOKEN@\">";
  std::ofstream(folder.path() / "vendor" / "a.js") << "export {};";
  const Page page(folder.path());
  Routes routes;
  routes.page = &page;
  HttpRequest request = Get("/");
  request.page_token = "secret";
  EXPECT_EQ(routes.Answer(request).body, "<meta content=\"secret\">");
  request.page_token.clear();
  EXPECT_EQ(routes.Answer(request).body, "<meta content=\"\">");
  EXPECT_EQ(routes.Answer(Get("/vendor/a.js")).content_type, "text/javascript; charset=utf-8");
  for (const char* path : {"/vendor", "/../index.html", "/vendor/../index.html", "/b.js", ""}) {
    EXPECT_EQ(routes.Answer(Get(path)).status, 404u) << path;
  }
  EXPECT_THROW(Page(folder.path() / "vendor"), UsageError);
}

TEST(ViewRoutes, CommandsNeedPermissionAndArmingNeedsTheOption) {
  Routes routes;
  std::vector<Command> taken;
  routes.command = [&taken](Command command) {
    taken.push_back(command);
    return std::string();
  };
  EXPECT_EQ(routes.Answer(Post("/api/estop", "no valid token")).status, 403u);
  EXPECT_EQ(routes.Answer(Get("/api/status")).status, 404u);
  EXPECT_EQ(routes.Answer(Post("/api/arm")).status, 403u);
  EXPECT_EQ(routes.Answer(Post("/api/reset")).status, 403u);
  EXPECT_EQ(routes.Answer(Post("/api/fly")).status, 404u);
  EXPECT_TRUE(taken.empty());
  EXPECT_EQ(routes.Answer(Post("/api/estop")).status, 202u);
  routes.allow_arming = true;
  EXPECT_EQ(routes.Answer(Post("/api/arm")).status, 202u);
  EXPECT_THAT(taken, ElementsAre(Command::kEstop, Command::kArm));
  routes.command = [](Command) { return std::string("an estop is not confirmed yet"); };
  EXPECT_EQ(routes.Answer(Post("/api/arm")).status, 409u);
  routes.command = nullptr;
  EXPECT_EQ(routes.Answer(Post("/api/estop")).status, 409u) << "a recording takes none";
  HttpRequest put = Get("/");
  put.method = "PUT";
  EXPECT_EQ(routes.Answer(put).status, 405u);
}

TEST(ViewRoutes, TheLogIsThatOfADomain) {
  Routes routes;
  EXPECT_EQ(routes.Answer(Get("/api/log")).status, 404u) << "a recording";
  ShownLog log;
  log.Add({0, msg::LogLevel::kWarning, "esn", "late"});
  routes.log = &log;
  HttpRequest request = Get("/api/log");
  EXPECT_EQ(routes.Answer(request).status, 400u);
  request.query = "after=0";
  EXPECT_THAT(routes.Answer(request).body, HasSubstr("late"));
}

TEST(ViewRoutes, OnlyFilesThatTheUrdfNamesAreServed) {
  const testing::TemporaryFolder folder;
  std::filesystem::create_directories(folder.path() / "urdf");
  std::filesystem::create_directories(folder.path() / "meshes");
  std::ofstream(folder.path() / "meshes" / "a b.stl") << "solid";
  std::ofstream(folder.path() / "meshes" / "other.stl") << "solid";
  std::ofstream(folder.path() / "urdf" / "robot.urdf")
      << R"(<robot name="r"><link name="base"><visual><geometry>)"
      << R"(<mesh filename="package://meshes/a b.stl"/></geometry></visual></link>)"
      << R"(<link name="arm"><inertial><mass value="1"/>)"
      << R"(<inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>)"
      << R"(<joint name="j" type="revolute"><parent link="base"/><child link="arm"/>)"
      << R"(<axis xyz="0 0 1"/><limit lower="-1" upper="1" effort="1" velocity="1"/></joint>)"
      << R"(</robot>)";
  const Robot robot(folder.path() / "urdf" / "robot.urdf");
  Routes routes;
  routes.robot = &robot;
  EXPECT_EQ(routes.Answer(Get("/robot/meshes/a%20b.stl")).body, "solid");
  EXPECT_EQ(routes.Answer(Get("/robot/meshes/other.stl")).status, 404u);
  EXPECT_EQ(routes.Answer(Get("/robot/../urdf/robot.urdf")).status, 404u);
  EXPECT_THAT(routes.Answer(Get("/robot.urdf")).body, HasSubstr("<robot"));
  routes.robot = nullptr;
  EXPECT_EQ(routes.Answer(Get("/robot.urdf")).status, 404u);
  EXPECT_EQ(PercentDecoded("%41%2f%4x%"), "A/%4x%");
}

std::string RobotWith(const std::string& visuals, const std::string& more = "") {
  return "<robot name='r'>\n<link name='base'>\n" + visuals + "</link>\n" + more +
         "<link name='arm'><inertial><mass value='1'/>"
         "<inertia ixx='1' ixy='0' ixz='0' iyy='1' iyz='0' izz='1'/></inertial></link>"
         "<joint name='j' type='revolute'><parent link='base'/><child link='arm'/>"
         "<limit lower='-1' upper='1' effort='1' velocity='1'/></joint></robot>";
}

std::string MeshOf(const std::string& uri) {
  return "<visual><geometry><mesh filename='" + uri + "'/></geometry></visual>\n";
}

// The names that the page has are those of the served URDF.
TEST(ViewRoutes, MeshesArePackageFileOrPlainPaths) {
  const testing::TemporaryFolder folder;
  const std::filesystem::path package = folder.path() / "cloned here";
  std::filesystem::create_directories(package / "urdf");
  std::filesystem::create_directories(package / "meshes");
  std::ofstream(package / "package.xml") << "<package/>";
  std::ofstream(package / "meshes" / "a b.stl") << "solid";
  const std::string path = (package / "urdf" / "r.urdf").string();
  const std::string mesh = std::filesystem::canonical(package / "meshes" / "a b.stl").string();
  std::string encoded = mesh;
  for (std::size_t at; (at = encoded.find(' ')) != std::string::npos;) {
    encoded.replace(at, 1, "%20");
  }
  for (const std::string& uri :
       {"package://two_legs/meshes/a b.stl", "package://cloned here/meshes/a b.stl",
        "package://meshes/a b.stl", "../meshes/a b.stl", "file://../meshes/a b.stl"}) {
    std::ofstream(path, std::ios::trunc) << RobotWith(MeshOf(uri));
    const Robot robot(path);
    const std::string name =
        uri.substr(uri.find("://") == std::string::npos ? 0 : uri.find("://") + 3);
    EXPECT_EQ(robot.Mesh(name).body, "solid") << uri;
    EXPECT_THAT(robot.urdf(), HasSubstr("filename=\"" + name + "\""));
  }
  for (const std::string& uri : {mesh, "file://" + mesh, "file://" + encoded}) {
    std::ofstream(path, std::ios::trunc) << RobotWith(MeshOf(uri));
    EXPECT_EQ(Robot(path).Mesh(mesh).body, "solid") << uri;
    EXPECT_THAT(Robot(path).urdf(), HasSubstr("filename=\"" + mesh + "\""));
  }
}

TEST(ViewRoutes, AMeshThatIsNotThereIsLoggedWithFileLineLinkAndName) {
  const testing::TemporaryFolder folder;
  const std::string path = (folder.path() / "r.urdf").string();
  std::string visuals;
  for (int i = 0; i < 14; ++i) {
    visuals += MeshOf((i % 2 == 0 ? "file:///none/" : "package://p/") + std::to_string(i) + ".stl");
  }
  std::ofstream(path) << RobotWith(visuals + visuals);
  std::ostringstream log;
  const auto before = spdlog::default_logger();
  spdlog::set_default_logger(std::make_shared<spdlog::logger>(
      "test", std::make_shared<spdlog::sinks::ostream_sink_st>(log)));
  const Robot robot(path);
  spdlog::set_default_logger(before);
  for (int i = 0; i < 10; ++i) {
    EXPECT_THAT(log.str(), HasSubstr(path + ":" + std::to_string(3 + i) + ": link 'base': mesh '" +
                                     (i % 2 == 0 ? "file:///none/" : "package://p/") +
                                     std::to_string(i) + ".stl' is not drawn: no such file in "));
  }
  EXPECT_THAT(log.str(), HasSubstr(path + ": 4 more files that it names are not drawn"));
  EXPECT_EQ(robot.Mesh("p/1.stl").status, 404u);
}

// The page's loader looks for a material at the top level, or in the visual itself.
TEST(ViewRoutes, TheServedUrdfHasTheMaterialsThatItRefersTo) {
  const testing::TemporaryFolder folder;
  const std::string path = (folder.path() / "r.urdf").string();
  const std::string box = "<visual><geometry><box size='1 1 1'/></geometry><material name='red'";
  std::ofstream(path) << RobotWith(
      box + "/></visual>",
      "<link name='z'>" + box +
          "><color rgba='1 0 0 1'/></material></visual></link>"
          "<joint name='f' type='fixed'><parent link='base'/><child link='z'/></joint>");
  const std::string urdf = Robot(path).urdf();
  EXPECT_LT(urdf.find("<material name=\"red\">"), urdf.find("<link"));
  EXPECT_LT(urdf.find("rgba=\"1 0 0 1\""), urdf.find("<link"));
}

TEST(ViewRoutes, TheBipedHasTwelveDrivenJoints) {
  const Robot robot(kViewRobotsFolder / "biped" / "biped.urdf");
  EXPECT_EQ(robot.driven().size(), 12u);
  EXPECT_GE(robot.moving().size(), 12u);
}

TEST(ViewConfig, OptionsGoBeforeTheFile) {
  const ViewOptions of_file = WithConfiguration({}, kViewRobotsFolder / "rig" / "view.yaml");
  EXPECT_EQ(of_file.urdf.filename(), "rig.urdf");
  EXPECT_EQ(of_file.port, kDefaultPort);
  ViewOptions given;
  given.port = 0;
  given.urdf = "mine.urdf";
  const ViewOptions merged = WithConfiguration(given, kViewRobotsFolder / "rig" / "view.yaml");
  EXPECT_EQ(merged.port, 0);
  EXPECT_EQ(merged.urdf, "mine.urdf");
  EXPECT_EQ(WithConfiguration({}, "").port, kDefaultPort);
}

TEST(ViewConfig, WhatIsWrongIsNamedByFileAndKey) {
  const testing::TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "view.yaml";
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"port: 70000\n", "port"}, {"urdf: none.urdf\n", "none.urdf"}, {"ports: 1\n", "ports"}};
  for (const auto& [text, expected] : cases) {
    std::ofstream(file, std::ios::trunc) << "schema: sinew-view/1\n" << text;
    try {
      WithConfiguration({}, file);
      FAIL() << text;
    } catch (const UsageError& error) {
      EXPECT_THAT(error.what(), HasSubstr("view.yaml:2"));
      EXPECT_THAT(error.what(), HasSubstr(expected));
    }
  }
}

TEST(RecordedViewQuery, IsReadOrNamedWhatIsMissing) {
  const RecordedView::Query query = ParseQuery("topics=a,b&from_ns=-5&to_ns=7");
  EXPECT_THAT(query.topics, ElementsAre("a", "b"));
  EXPECT_EQ(query.from_ns, -5);
  EXPECT_EQ(query.to_ns, 7);
  for (const char* text : {"", "topics=a", "topics=a&from_ns=1", "topics=a&from_ns=1&to_ns=x",
                           "topics=a&from_ns=1&to_ns="}) {
    EXPECT_THROW(ParseQuery(text), UsageError) << text;
  }
}

}  // namespace
}  // namespace sinew::live
