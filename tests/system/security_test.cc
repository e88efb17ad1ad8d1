// A robot with DDS security: certificates by role, what each may do, and what a stolen one may not.
// Domains 165, 166.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <limits.h>
#include <netinet/in.h>
#include <poll.h>
#include <sinew_idl/joint.h>
#include <sys/inotify.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <sstream>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "components/base/config/config.h"
#include "components/topics/node/codec.h"
#include "tests/components/topics/node/datagrams.h"
#include "tests/support/program.h"
#include "tests/support/sinew_program.h"
#include "tests/support/skip.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test_host.h"
#include "tests/tools/view/view_program.h"
#include "tools/security/authority.h"
#include "tools/security/documents.h"

namespace sinew::testing {
namespace {

using namespace std::chrono_literals;
namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr auto kLimit = 30s;
// Longer than the half second between two announcements.
const std::vector<std::string> kStranger = {"--timeout", "2"};

Finished Sinew(std::vector<std::string> words, const std::vector<std::string>& more) {
  words.insert(words.begin(), kSinew);
  words.insert(words.end(), more.begin(), more.end());
  return testing::Run(words, kLimit);
}

// The answer comes within a tenth of a second of the first announcement that is heard.
Finished Operate(const std::string& action, const std::vector<std::string>& more) {
  return Sinew({action, "--domain", "165"}, more);
}

// A surrogate with certificates, which runs until the end.
class SecureRobot {
 public:
  SecureRobot() {
    const std::string deployment = folder_.Write(
        "one.yaml",
        "schema: sinew-deployment/1\nname: one\ndomain_id: 165\nnetwork: {security: keys}\n"
        "provider: surrogate\nprocesses:\n  - {name: surrogate, program: sinew-surrogate}\n");
    const Finished init = Sinew({"security", "init", deployment}, {});
    EXPECT_EQ(init.exit_code, 0) << init.error;
    launch_.emplace(std::vector<std::string>{kSinew, "launch", deployment});
  }

  fs::path keys() const { return folder_.path() / "keys"; }
  std::vector<std::string> As(const std::string& name) const {
    return {"--qos", keys() / name / "qos.xml"};
  }
  // One more certificate.
  void Add(const std::string& role, const std::string& name,
           const std::vector<std::string>& more = {}) const {
    std::vector<std::string> words = {"--folder", keys()};
    words.insert(words.end(), more.begin(), more.end());
    const Finished add = Sinew({"security", "add", role, name, "elsewhere"}, words);
    EXPECT_EQ(add.exit_code, 0) << add.error;
  }
  // What the doctor says, once it has heard the robot: the handshake takes as long as the machine
  // lets it.
  Finished Doctor(const std::string& name) const {
    const auto end = std::chrono::steady_clock::now() + kLimit;
    Finished doctor;
    do {
      doctor = Sinew({"doctor", "--domain", "165", "--recordings", "/", "--wait", "1.2"}, As(name));
    } while (doctor.output.find("participants: 1") == std::string::npos &&
             std::chrono::steady_clock::now() < end);
    return doctor;
  }
  // The last state that somebody hears.
  std::string State(const std::string& name = "observer") const {
    std::vector<std::string> more = As(name);
    more.insert(more.end(), {"--domain", "165", "--count", "1", "--field", "robot_state"});
    return Sinew({"echo", "joint_state"}, more).output;
  }
  bool Ends() {
    launch_->Signal(SIGINT);
    return launch_->Wait(kLimit) == 0;
  }
  std::string error() const { return launch_->error(); }

 private:
  TemporaryFolder folder_;
  std::optional<Program> launch_;
};

TEST(Security, AnOperatorCommandsAndWithoutACertificateNobodySeesTheRobot) {
  SecureRobot robot;
  const Finished armed = Operate("arm", robot.As("operator"));
  EXPECT_EQ(armed.exit_code, 0) << armed.error << robot.error();

  const Finished stranger = Operate("disarm", kStranger);
  EXPECT_EQ(stranger.exit_code, 1);
  EXPECT_THAT(stranger.error, HasSubstr("no state provider heard in domain 165"));
  EXPECT_THAT(Sinew({"list", "--domain", "165", "--wait", "1.2"}, {}).output,
              HasSubstr("0 participants"));

  EXPECT_EQ(Operate("estop", robot.As("operator")).exit_code, 0);
  EXPECT_EQ(Operate("reset", robot.As("operator")).exit_code, 0);
  EXPECT_TRUE(robot.Ends()) << robot.error();
}

TEST(Security, AnObserverSeesAllAndCommandsNothing) {
  SecureRobot robot;
  const auto look = [&](std::vector<std::string> words, const std::vector<std::string>& more) {
    words.insert(words.end(), {"--domain", "165"});
    words.insert(words.end(), more.begin(), more.end());
    return Sinew(words, robot.As("observer"));
  };
  const Finished arm = Operate("arm", robot.As("observer"));
  EXPECT_EQ(arm.exit_code, 2);
  EXPECT_THAT(arm.error, HasSubstr("no DDS writer for topic 'operator_command': the certificate"));
  EXPECT_THAT(robot.State(), HasSubstr("DISARMED"));

  const Finished list = look({"list"}, {"--wait", "1.2"});
  EXPECT_EQ(list.exit_code, 0) << list.error;
  EXPECT_THAT(list.output, HasSubstr("surrogate    active"));
  const TemporaryFolder folder;
  const std::string recording = folder.path() / "run.mcap";
  const Finished record = look({"record", "--out", recording}, {"--duration", "2"});
  EXPECT_EQ(record.exit_code, 0) << record.error;
  EXPECT_THAT(Sinew({"list", recording}, {}).output, HasSubstr("joint_state"));
  const Finished doctor = robot.Doctor("observer");
  EXPECT_THAT(doctor.output, HasSubstr("participants: 1"));
  EXPECT_THAT(doctor.output, HasSubstr("whoever lacks it is not heard"));
  EXPECT_EQ(doctor.exit_code, 0) << doctor.output;
}

TEST(Security, ThePageOfAnObserverShowsTheRobot) {
  SecureRobot robot;
  std::vector<std::string> words = robot.As("observer");
  words.insert(words.end(), {"--domain", "165"});
  View view(words);
  const Finished client = view.Ask({"receive", "100"});
  EXPECT_EQ(client.exit_code, 0) << client.error << view.log();
  EXPECT_THAT(view.log(), HasSubstr("the page shows and commands nothing: no DDS writer for topic "
                                    "'operator_command'"));
  EXPECT_EQ(view.End(), 0) << view.log();
}

// One that may write nothing at all, its component_status included.
TEST(Security, WhoMayOnlySubscribeStillReads) {
  SecureRobot robot;
  const fs::path mute = robot.keys() / "mute";
  robot.Add("observer", "mute");
  const std::string authority = config::ReadFile(robot.keys() / "authority/permissions_ca.pem");
  std::string permissions =
      security::Verified(config::ReadFile(mute / security::kPermissions), authority).value();
  const std::size_t begin = permissions.find("<publish>"), end = permissions.find("<subscribe>");
  permissions.erase(begin, end - begin);
  config::WriteFileAtomically(
      mute / security::kPermissions,
      security::Sign({authority, config::ReadFile(robot.keys() / "authority/permissions_ca.key")},
                     permissions));
  const Finished list = Sinew({"list", "--domain", "165"}, robot.As("mute"));
  EXPECT_EQ(list.exit_code, 0) << list.error;
  EXPECT_THAT(list.output, HasSubstr("surrogate    active"));
  EXPECT_THAT(robot.State("mute"), HasSubstr("DISARMED"));
  const Finished doctor = robot.Doctor("mute");
  EXPECT_THAT(doctor.output, HasSubstr("participants: 1"));
  EXPECT_THAT(doctor.output, HasSubstr("whoever lacks it is not heard"));
  EXPECT_NE(Operate("arm", robot.As("mute")).exit_code, 0);
}

// A file in whose place its first reader finds something else. It is a pipe until then.
class TwiceRead {
 public:
  TwiceRead(const fs::path& file, const std::string& first) {
    const std::string second = config::ReadFile(file);
    EXPECT_LT(first.size(), static_cast<std::size_t>(PIPE_BUF));  // read at once
    fs::remove(file);
    EXPECT_EQ(::mkfifo(file.c_str(), 0600), 0);
    pipe_ = ::open(file.c_str(), O_RDWR | O_CLOEXEC);  // for both, so that it does not wait
    events_ = ::inotify_init1(IN_CLOEXEC);
    EXPECT_GE(::inotify_add_watch(events_, file.c_str(), IN_OPEN | IN_CLOSE_NOWRITE), 0);
    Write(first);
    thread_ = std::jthread([this, second] {
      if (Await(IN_CLOSE_NOWRITE)) Write(second);
      (void)Await(IN_OPEN);  // what is in a pipe that nobody has opened is lost
      ::close(pipe_);
    });
  }
  ~TwiceRead() {
    thread_.join();
    ::close(events_);
  }
  TwiceRead(const TwiceRead&) = delete;
  TwiceRead& operator=(const TwiceRead&) = delete;

 private:
  void Write(const std::string& text) const {
    EXPECT_EQ(::write(pipe_, text.data(), text.size()), static_cast<ssize_t>(text.size()));
  }

  bool Await(std::uint32_t wanted) const {
    inotify_event event{};
    do {
      pollfd next{events_, POLLIN, 0};
      const auto limit = static_cast<int>(std::chrono::milliseconds(kLimit).count());
      if (::poll(&next, 1, limit) != 1) return false;
      // One at a time: an event of a file that is watched itself has no name.
      if (::read(events_, &event, sizeof(event)) != sizeof(event)) return false;
    } while ((event.mask & wanted) == 0);
    return true;
  }

  int events_ = -1, pipe_ = -1;
  std::jthread thread_;
};

// A thief has an observer's files, and may change them and the library that reads them.
class StolenKey : public ::testing::Test {
 protected:
  fs::path Stolen(const std::string& name) const {
    const fs::path copy = robot_.keys() / ("stolen_" + name);
    fs::copy(robot_.keys() / name, copy);
    return copy;
  }
  static std::string OperatorsPermissions(const fs::path& stolen) {
    const auto facts = security::FactsOf(config::ReadFile(stolen / security::kCertificate));
    return security::Permissions({.name = "thief",
                                  .subject = facts.subject,
                                  .roles = {"operator"},
                                  .domain_id = 165,
                                  .not_before = "2020-01-01T00:00:00",
                                  .not_after = "2050-01-01T00:00:00"});
  }
  // What `authority` signs is good for the thief's own library. Behind the real one: the name of
  // the first one is announced.
  static void Trust(const fs::path& stolen, const std::string& authority) {
    const fs::path file = stolen / security::kPermissionsAuthority;
    config::WriteFileAtomically(file, config::ReadFile(file) + authority);
  }
  // Its own library asks permissions that the thief has signed, and sends the real ones.
  static TwiceRead AllowItself(const fs::path& stolen) {
    const auto now =
        std::chrono::time_point_cast<security::Seconds::duration>(std::chrono::system_clock::now());
    const auto own = security::MakeAuthority(security::Authority::kForPermissions, "thief",
                                             {now - 1h, now + 1h});
    Trust(stolen, own.certificate);
    return TwiceRead(stolen / security::kPermissions,
                     security::Sign(own, OperatorsPermissions(stolen)));
  }
  static Finished Arm(const fs::path& stolen) {
    return Operate("arm", {"--qos", stolen / "qos.xml", "--timeout", "3"});
  }

  SecureRobot robot_;
};

TEST_F(StolenKey, OfAnObserverDoesNotArmWhateverItsOwnLibraryAllows) {
  const fs::path observer = Stolen("observer"), operator_ = Stolen("operator");
  const TwiceRead permissions = AllowItself(observer);
  const Finished arm = Arm(observer);
  EXPECT_EQ(arm.exit_code, 1);
  EXPECT_THAT(arm.error, HasSubstr("the robot is heard, but nobody takes commands"));
  EXPECT_THAT(robot_.State(), HasSubstr("DISARMED"));
  // It was the role: an operator arms with the same trick.
  const TwiceRead other_permissions = AllowItself(operator_);
  const Finished armed = Arm(operator_);
  EXPECT_EQ(armed.exit_code, 0) << armed.error;
}

TEST_F(StolenKey, DoesNotArmWithThePermissionsOfSomebodyElse) {
  const fs::path observer = Stolen("observer");
  fs::copy_file(robot_.keys() / "operator" / security::kPermissions,
                observer / security::kPermissions, fs::copy_options::overwrite_existing);
  const Finished arm = Arm(observer);
  EXPECT_EQ(arm.exit_code, 2);
  EXPECT_THAT(arm.error, HasSubstr("no DDS participant in domain 165"));
  EXPECT_THAT(robot_.State(), HasSubstr("DISARMED"));
}

TEST_F(StolenKey, DoesNotSignPermissionsForItself) {
  const fs::path observer = Stolen("observer");
  const std::string signed_by_itself =
      security::Sign({config::ReadFile(observer / security::kCertificate),
                      config::ReadFile(observer / security::kPrivateKey)},
                     OperatorsPermissions(observer));
  config::WriteFileAtomically(observer / security::kPermissions, signed_by_itself);
  Trust(observer, config::ReadFile(observer / security::kIdentityAuthority));
  const Finished arm = Arm(observer);
  EXPECT_EQ(arm.exit_code, 1);
  EXPECT_THAT(arm.error, HasSubstr("no state provider heard in domain 165"));
  EXPECT_THAT(robot_.State(), HasSubstr("DISARMED"));
}

// UDP ports of a process.
std::vector<int> PortsOf(pid_t pid) {
  const fs::path process = "/proc/" + std::to_string(pid);
  std::set<std::string> inodes;
  for (const auto& entry : fs::directory_iterator(process / "fd")) {
    std::error_code ignored;
    const std::string target = fs::read_symlink(entry.path(), ignored).string();
    if (target.starts_with("socket:[")) inodes.insert(target.substr(8, target.size() - 9));
  }
  std::vector<int> ports;
  std::ifstream table(process / "net/udp");
  std::string line, word;
  std::getline(table, line);
  while (std::getline(table, line)) {
    std::istringstream words(line);
    std::vector<std::string> row;
    while (words >> word) row.push_back(word);
    constexpr std::size_t kLocal = 1, kInode = 9;
    if (row.size() <= kInode || !inodes.contains(row[kInode])) continue;
    ports.push_back(std::stoi(row[kLocal].substr(row[kLocal].find(':') + 1), nullptr, 16));
  }
  return ports;
}

// The 16 bytes of "01.0f. ... |0.0.1.3".
std::vector<std::uint8_t> BytesOf(std::string guid) {
  std::replace_if(
      guid.begin(), guid.end(), [](char c) { return c == '.' || c == '|'; }, ' ');
  std::istringstream words(guid);
  std::vector<std::uint8_t> bytes;
  for (int byte = 0; words >> std::hex >> byte;) bytes.push_back(static_cast<std::uint8_t>(byte));
  return bytes;
}

constexpr std::uint64_t kForgedTick = 77'777'777'777;

// A joint_state in the name of this writer, newer than all of its own, as whoever has no keys can
// send it.
node::testing::Datagram ForgedState(const std::vector<std::uint8_t>& writer) {
  msg::JointState state;
  state.header.tick = kForgedTick;
  node::Bytes bytes;
  EXPECT_TRUE(node::Encode(state, &bytes));
  node::testing::Datagram payload;
  for (const std::byte byte : bytes) payload.push_back(static_cast<std::uint8_t>(byte));
  node::testing::Datagram out = node::testing::Header();
  std::copy_n(writer.begin(), 12, out.begin() + 8);
  node::testing::Datagram data = node::testing::Data({0, 0, 0, 0}, payload, 1'000'000'000);
  std::copy_n(writer.begin() + 12, 4, data.begin() + 8);
  node::testing::AddSubmessage(&out, node::testing::kDataId, data, node::testing::kWithPayload);
  return out;
}

// Fast DDS 2.9 reads what is not encrypted as well: the filter in front of it does not let it.
TEST(Security, APlainSampleInTheNameOfAWriterIsNotRead) {
  SecureRobot robot;
  const auto list = nlohmann::json::parse(
      Sinew({"list", "--domain", "165", "--json"}, robot.As("observer")).output);
  std::string guid;
  for (const auto& endpoint : list["endpoints"]) {
    if (endpoint["topic"] == "joint_state") guid = endpoint["guid"];
  }
  ASSERT_EQ(BytesOf(guid).size(), 16u) << guid;
  const node::testing::Datagram forged = ForgedState(BytesOf(guid));
  const auto reads_it = [&](const std::string& name) {
    std::vector<std::string> words = {kSinew, "echo",    "joint_state", "--domain",
                                      "165",  "--field", "header.tick", "--json"};
    for (const std::string& word : robot.As(name)) words.push_back(word);
    Program echo(words);
    EXPECT_TRUE(echo.WaitForText("header.tick", kLimit)) << echo.error();
    const int sender = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    for (const int port : PortsOf(echo.pid())) {
      sockaddr_in to{};
      to.sin_family = AF_INET;
      to.sin_port = htons(static_cast<std::uint16_t>(port));
      to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
      ::sendto(sender, forged.data(), forged.size(), 0, reinterpret_cast<const sockaddr*>(&to),
               sizeof to);
    }
    ::close(sender);
    const bool read = echo.WaitForText(std::to_string(kForgedTick), 3s);
    return std::pair(read, echo.error());
  };
  const auto [read, error] = reads_it("observer");
  EXPECT_FALSE(read);
  EXPECT_THAT(error, HasSubstr("not protected by DDS security and was dropped"));

  // Without the property that turns the filter on, the library reads it.
  robot.Add("observer", "naive");
  const fs::path qos = robot.keys() / "naive/qos.xml";
  std::string profiles = config::ReadFile(qos);
  for (std::size_t at; (at = profiles.find("sinew.security.protected")) != std::string::npos;) {
    profiles.replace(at, 24, "sinew.security.none");
  }
  config::WriteFileAtomically(qos, profiles);
  EXPECT_TRUE(reads_it("naive").first);
}

// Debian's, without the end of the names.
const std::string kCyclonePlugins = "/usr/lib/x86_64-linux-gnu/libddsc0debian/libdds_security_";

// Cyclone DDS with the files of a certificate.
std::string CycloneSettings(const fs::path& certificate) {
  const auto library = [&](const std::string& name, const std::string& function) {
    return "<Library path=\"" + kCyclonePlugins + name + ".so\" initFunction=\"init_" + function +
           "\" finalizeFunction=\"finalize_" + function + "\"/>";
  };
  const auto file = [&](const std::string& key, const char* name) {
    return "<" + key + ">file:" + (certificate / name).string() + "</" + key + ">";
  };
  return "<CycloneDDS><Domain id=\"any\">"
         "<General><Interfaces><NetworkInterface name=\"lo\" multicast=\"true\"/></Interfaces>"
         "</General><Discovery><LeaseDuration>3 s</LeaseDuration>"
         "<SPDPInterval>500 ms</SPDPInterval></Discovery><Security><Authentication>" +
         library("auth", "authentication") + file("IdentityCA", security::kIdentityAuthority) +
         file("IdentityCertificate", security::kCertificate) +
         file("PrivateKey", security::kPrivateKey) + "</Authentication><AccessControl>" +
         library("ac", "access_control") + file("PermissionsCA", security::kPermissionsAuthority) +
         file("Governance", security::kGovernance) + file("Permissions", security::kPermissions) +
         "</AccessControl><Cryptographic>" + library("crypto", "crypto") +
         "</Cryptographic></Security></Domain></CycloneDDS>\n";
}

// A reference in C with Cyclone DDS (tests/install/cyclone).
std::vector<std::string> CycloneReference(const std::string& settings) {
  return {"env", "CYCLONEDDS_URI=" + settings,
          std::string(SINEW_TEST_BIN_DIR) + "/cyclone-reference", "--domain", "165"};
}

TEST(Security, AParticipantOfCycloneDdsDoesWhatItsRoleMay) {
  SKIP_WITHOUT_PACKAGE(fs::exists(kCyclonePlugins + "auth.so"), "libddsc0debian");
  SecureRobot robot;
  robot.Add("reference", "swing", {"--other-dds"});
  robot.Add("observer", "guest", {"--other-dds"});
  const auto hears = [&](const std::string& wait) {
    std::vector<std::string> more = robot.As("observer");
    more.insert(more.end(), {"--domain", "165", "--count", "1", "--timeout", wait});
    return Sinew({"echo", "reference"}, more).exit_code == 0;
  };
  {
    Program reference(CycloneReference(CycloneSettings(robot.keys() / "swing")));
    EXPECT_TRUE(hears("20")) << reference.error();
    EXPECT_THAT(Sinew({"list", "--domain", "165"}, robot.As("observer")).output,
                HasSubstr("reference-c  active"));
    reference.Signal(SIGINT);
    EXPECT_EQ(reference.Wait(kLimit), 0) << reference.error();
  }
  Program guest(CycloneReference(CycloneSettings(robot.keys() / "guest")));
  EXPECT_TRUE(guest.WaitForText("writer: Not Allowed By Security", kLimit)) << guest.error();
  // Without a certificate it waits for a robot that it does not see.
  Program stranger(
      CycloneReference("file://" SINEW_SOURCE_DIR "/tests/install/cyclone/loopback.xml"));
  EXPECT_FALSE(hears("3"));
  EXPECT_THAT(Sinew({"list", "--domain", "165"}, robot.As("observer")).output,
              Not(HasSubstr("reference-c")));
}

// Every program of the rig has the rights that it needs, and no more is asked for.
TEST(Security, TheWholeRigRunsWithCertificatesOfItsRoles) {
  const TemporaryFolder folder;
  const fs::path rig = std::string(SINEW_SOURCE_DIR) + "/robots/rig";
  for (const auto& entry : fs::directory_iterator(rig)) {
    if (entry.is_regular_file()) fs::copy(entry.path(), folder.path());
  }
  std::string text = config::ReadFile(rig / "deploy_rig.yaml");
  const std::string domain = "domain_id: 0\n";
  ASSERT_NE(text.find(domain), std::string::npos);
  text.replace(text.find(domain), domain.size(), "domain_id: 165\nnetwork: {security: keys}\n");
  const std::string deployment = folder.Write("deploy_rig.yaml", text);
  ASSERT_EQ(Sinew({"security", "init", deployment}, {}).exit_code, 0);
  const std::string recording = folder.path() / "run.mcap";
  const Finished run = Sinew(
      {"launch", deployment, "--mode", "lockstep", "--duration", "1", "--record", recording}, {});
  EXPECT_EQ(run.exit_code, 0) << run.output << run.error;
  EXPECT_THAT(run.output, Not(HasSubstr("does not allow")));
  const Finished list = Sinew({"list", recording}, {});
  for (const char* topic : {"joint_command", "valve_command", "torque_prediction", "readout",
                            "reference", "regime", "component_snapshot"}) {
    EXPECT_THAT(list.output, HasSubstr(topic));
  }
  // Nobody who gets the recording gets the keys.
  const std::string bytes = config::ReadFile(recording);
  EXPECT_EQ(bytes.find("PRIVATE KEY"), std::string::npos);
  const Finished other = Sinew(
      {"launch", deployment, "--mode", "lockstep", "--duration", "1", "--set", "domain_id=166"},
      {});
  EXPECT_NE(other.exit_code, 0);
}

TEST(Security, AProcessWithoutACertificateIsNotStarted) {
  const TemporaryFolder folder;
  const std::string deployment = folder.Write(
      "one.yaml",
      "schema: sinew-deployment/1\nname: one\ndomain_id: 165\nnetwork: {security: keys}\n"
      "provider: surrogate\nprocesses:\n  - {name: surrogate, program: sinew-surrogate}\n");
  const Finished launch = Sinew({"launch", deployment}, {});
  EXPECT_EQ(launch.exit_code, 2);
  EXPECT_THAT(launch.error, HasSubstr("keys/surrogate/qos.xml: no certificate of process "
                                      "'surrogate', expected one of 'sinew security init'"));
}

// Keys of a deployment: datagrams without their tag are not read.
std::string MakeKey(const TemporaryFolder& folder, const std::string& name, char digit) {
  const std::string file = folder.Write(name, std::string(64, digit) + "\n");
  fs::permissions(file, fs::perms::owner_read);
  return file;
}

TEST(Security, WithoutTheKeyOfTheDeploymentNobodySeesTheRobot) {
  const TemporaryFolder folder;
  const std::string key = MakeKey(folder, "deployment.key", 'a');
  const std::string other = MakeKey(folder, "other.key", 'b');
  const std::string deployment = folder.Write(
      "deploy.yaml",
      "schema: sinew-deployment/1\nname: one\ndomain_id: 165\nnetwork: {key: deployment.key}\n"
      "provider: surrogate\nprocesses:\n  - {name: surrogate, program: sinew-surrogate}\n");
  Program launch({kSinew, "launch", deployment});
  const Finished armed = Operate("arm", {"--key", key});
  EXPECT_EQ(armed.exit_code, 0) << armed.error << launch.error();
  const Finished stranger = Operate("disarm", kStranger);
  EXPECT_EQ(stranger.exit_code, 1);
  EXPECT_THAT(stranger.error, HasSubstr("no state provider heard in domain 165"));
  EXPECT_THAT(stranger.error, HasSubstr("this process has no key (--key, SINEW_KEY)"));
  EXPECT_EQ(Operate("disarm", {"--timeout", "2", "--key", other}).exit_code, 1);
  EXPECT_EQ(Operate("estop", {"--key", key}).exit_code, 0);
  launch.Signal(SIGINT);
  EXPECT_EQ(launch.Wait(kLimit), 0) << launch.error();
}

// On an interface that the deployment opens to it, DDS security does instead of the key; nowhere
// else.
TEST(Security, WhereAnInterfaceIsOpenTheKeysOfDdsSecurityDoInsteadOfTheDeploymentsKey) {
  const TwoHosts hosts;
  SKIP_WITHOUT_KERNEL(hosts.why_not().empty(), hosts.why_not());
  const TemporaryFolder folder;
  const std::string deployment = folder.Write(
      "one.yaml",
      "schema: sinew-deployment/1\nname: one\ndomain_id: 166\nnetwork: {security: keys}\n"
      "provider: surrogate\nprocesses:\n  - {name: surrogate, program: sinew-surrogate}\n");
  ASSERT_EQ(Sinew({"security", "init", deployment}, {}).exit_code, 0);
  const std::string provider = folder.path() / "keys/surrogate/qos.xml";
  const std::string profiles = folder.path() / "keys/operator/qos.xml";
  const std::string key = MakeKey(folder, "deployment.key", 'a');
  Program surrogate(
      hosts.On(0, {std::string(SINEW_BIN_DIR) + "/sinew-surrogate", "--domain", "166", "--qos",
                   provider, "--key", key, "--interface", "wire0", "--open", "wire0"}));
  const auto estop = [&](int host, const std::vector<std::string>& more) {
    std::vector<std::string> words = {kSinew, "estop", "--domain", "166", "--qos", profiles};
    words.insert(words.end(), more.begin(), more.end());
    return testing::Run(hosts.On(host, words), kLimit).exit_code;
  };
  // Both sides are new, and each handshake that loses a datagram waits for the next announcement.
  EXPECT_EQ(estop(1, {"--interface", "wire0", "--timeout", "20"}), 0) << surrogate.error();
  EXPECT_EQ(estop(0, {"--key", key, "--timeout", "20"}), 0) << surrogate.error();
  EXPECT_EQ(estop(0, kStranger), 1);
}

}  // namespace
}  // namespace sinew::testing
