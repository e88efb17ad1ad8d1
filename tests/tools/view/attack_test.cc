// What others do to a running sinew-view: the page and its estop stay. Domain 228.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <memory>
#include <regex>
#include <string>
#include <vector>

#include "tests/support/temporary_folder.h"
#include "tests/tools/view/socket_client.h"
#include "tests/tools/view/view_program.h"
#include "tools/view/server.h"

namespace sinew::live {
namespace {

using std::chrono::milliseconds;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

class ViewAttack : public ::testing::Test {
 protected:
  void Start(std::vector<std::string> options = {}) {
    options.insert(options.begin(), {"--domain", "228"});
    view_ = std::make_unique<testing::View>(options);
    ASSERT_NE(view_->port(), "") << view_->log();
    port_ = static_cast<unsigned short>(std::stoi(view_->port()));
    site_ = "http://127.0.0.1:" + view_->port();
  }

  std::string Ask(const std::string& line, const std::string& headers = "") const {
    Connection connection(port_);
    connection.Send(RequestText(port_, line, headers + "Connection: close\r\n"));
    return connection.ReadAll();
  }

  std::string Token() const {
    const std::string page = Ask("GET /");
    std::smatch match;
    static const std::regex kToken("name=\"sinew-token\" content=\"([0-9a-f]{32})\"");
    return std::regex_search(page, match, kToken) ? std::string(match[1]) : std::string();
  }

  // As a browser does that opens the page and presses the button.
  std::string PressEstop() const {
    return Ask("POST /api/estop", "Origin: " + site_ + "\r\nX-Sinew-Token: " + Token() + "\r\n");
  }

  void OpenForeignSockets(int count) {
    for (int i = 0; i < count; ++i) {
      foreign_.push_back(std::make_unique<Connection>(port_));
      foreign_.back()->Send(UpgradeRequest(port_, "/", "http://evil.example"));
      foreign_.back()->ReadHead();
    }
  }

  std::size_t Resident_bytes() const {
    std::ifstream pages("/proc/" + std::to_string(view_->pid()) + "/statm");
    std::size_t all = 0, resident = 0;
    pages >> all >> resident;
    return resident * static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
  }

  std::unique_ptr<testing::View> view_;
  unsigned short port_ = 0;
  std::string site_;
  std::vector<std::unique_ptr<Connection>> foreign_;
};

TEST_F(ViewAttack, TheSocketsOfAnotherPageLeaveThePageItsEstopAndItsSocket) {
  ASSERT_NO_FATAL_FAILURE(Start());
  OpenForeignSockets(64);
  EXPECT_THAT(PressEstop(), StartsWith("HTTP/1.1 202"));
  Connection page(port_);
  page.Send(UpgradeRequest(port_, "/?token=" + Token(), site_));
  ASSERT_THAT(page.ReadHead(), StartsWith("HTTP/1.1 101"));
  OpenForeignSockets(64);
  EXPECT_THAT(page.ReadFrame().payload, HasSubstr("serverInfo"));
  EXPECT_THAT(page.ReadFrame().payload, HasSubstr("advertise"));
  page.SendText("still there");
  EXPECT_THAT(page.ReadFrame().payload, HasSubstr("not a JSON object"));
}

TEST_F(ViewAttack, HalfSentRequestsLeaveThePageAndItsEstop) {
  ASSERT_NO_FATAL_FAILURE(Start());
  for (int i = 0; i < 200; ++i) {
    foreign_.push_back(std::make_unique<Connection>(port_));
    foreign_.back()->Send("GET / HTTP/1.1\r\nHost: ");
  }
  EXPECT_THAT(PressEstop(), StartsWith("HTTP/1.1 202"));
}

TEST_F(ViewAttack, AClientThatNeverReadsCostsBoundedMemory) {
  ASSERT_NO_FATAL_FAILURE(Start());
  OpenForeignSockets(1);
  const std::size_t before = Resident_bytes();
  const std::string frame = TextFrame("{\"op\":\"" + std::string(60000, 'x') + "\"}");
  for (int i = 0; i < 1000; ++i) {
    if (!foreign_[0]->TrySend(frame, milliseconds(300))) break;
  }
  EXPECT_LT(Resident_bytes() - before, kClientBytes);
  EXPECT_THAT(PressEstop(), StartsWith("HTTP/1.1 202"));
}

TEST_F(ViewAttack, FilesOutsideThePackageOfTheUrdfAreNotServed) {
  const testing::TemporaryFolder folder;
  const std::filesystem::path package = folder.path() / "two_legs";
  std::filesystem::create_directories(package / "urdf");
  std::filesystem::create_directory(package / "meshes");
  const std::string secret = (folder.path() / "secret").string();
  std::ofstream(secret) << "a secret";
  std::ofstream(package / "package.xml") << "<package/>";
  std::ofstream(package / "meshes" / "leg.stl") << "a mesh";
  std::filesystem::create_symlink(secret, package / "meshes" / "link.stl");
  std::filesystem::create_symlink("leg.stl", package / "meshes" / "same.stl");
  const std::vector<std::string> inside = {"two_legs/meshes/leg.stl", "../meshes/leg.stl",
                                           "meshes/same.stl"};
  const std::vector<std::string> outside = {"../../secret",
                                            secret,
                                            "secret",
                                            "meshes/link.stl",
                                            "two_legs/../secret",
                                            "../../../../../../etc/passwd"};
  std::string visuals;
  for (const auto& names : {inside, outside}) {
    for (const std::string& name : names) {
      visuals += "<visual><geometry><mesh filename=\"package://" + name +
                 "\"/></geometry></visual><visual><geometry><mesh filename=\"" + name +
                 "\"/></geometry></visual>";
    }
  }
  std::ofstream(package / "urdf" / "robot.urdf")
      << R"(<robot name="r"><link name="base">)" << visuals << R"(</link><link name="arm">)"
      << R"(<inertial><mass value="1"/>)"
      << R"(<inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>)"
      << R"(<joint name="j" type="revolute"><parent link="base"/><child link="arm"/>)"
      << R"(<axis xyz="0 0 1"/><limit lower="-1" upper="1" effort="1" velocity="1"/></joint>)"
      << R"(</robot>)";
  ASSERT_NO_FATAL_FAILURE(Start({"--urdf", (package / "urdf" / "robot.urdf").string()}));
  for (const std::string& name : inside) {
    EXPECT_THAT(Ask("GET /robot/" + name), HasSubstr("a mesh")) << name;
  }
  for (const std::string& name : outside) {
    EXPECT_THAT(Ask("GET /robot/" + name), StartsWith("HTTP/1.1 404")) << name;
  }
  const std::string log = view_->log();
  for (const std::string& name : outside) {
    EXPECT_THAT(log, HasSubstr("link 'base': mesh 'package://" + name +
                               "' is not drawn: no such file in "));
  }
}

}  // namespace
}  // namespace sinew::live
