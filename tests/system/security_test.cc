// A robot with DDS security: who has its keys operates it, who has none does not see it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <filesystem>
#include <string>
#include <vector>

#include "components/base/config/config.h"
#include "tests/support/program.h"
#include "tests/support/sinew_program.h"
#include "tests/support/skip.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test_host.h"

namespace sinew::testing {
namespace {

using namespace std::chrono_literals;
using ::testing::HasSubstr;

constexpr auto kLimit = 30s;

// Every participant of every topic of the domains that Fast DDS knows here, with all protection.
constexpr char kGovernance[] = R"(<?xml version="1.0" encoding="UTF-8"?>
<dds><domain_access_rules><domain_rule>
<domains><id_range><min>0</min><max>230</max></id_range></domains>
<allow_unauthenticated_participants>false</allow_unauthenticated_participants>
<enable_join_access_control>true</enable_join_access_control>
<discovery_protection_kind>ENCRYPT</discovery_protection_kind>
<liveliness_protection_kind>ENCRYPT</liveliness_protection_kind>
<rtps_protection_kind>ENCRYPT</rtps_protection_kind>
<topic_access_rules><topic_rule><topic_expression>*</topic_expression>
<enable_discovery_protection>true</enable_discovery_protection>
<enable_liveliness_protection>true</enable_liveliness_protection>
<enable_read_access_control>true</enable_read_access_control>
<enable_write_access_control>true</enable_write_access_control>
<metadata_protection_kind>ENCRYPT</metadata_protection_kind>
<data_protection_kind>ENCRYPT</data_protection_kind>
</topic_rule></topic_access_rules></domain_rule></domain_access_rules></dds>
)";
constexpr char kPermissions[] = R"(<?xml version="1.0" encoding="UTF-8"?>
<dds><permissions><grant name="robot"><subject_name>CN=robot</subject_name>
<validity><not_before>2020-01-01T00:00:00</not_before><not_after>2050-01-01T00:00:00</not_after></validity>
<allow_rule><domains><id_range><min>0</min><max>230</max></id_range></domains>
<publish><topics><topic>*</topic></topics></publish>
<subscribe><topics><topic>*</topic></topics></subscribe></allow_rule>
<default>DENY</default></grant></permissions></dds>
)";

// Keys, certificates and signed documents of one robot, and the QoS profiles that name them.
std::string MakeSecureProfiles(const TemporaryFolder& folder) {
  const std::string at = folder.path().string() + "/";
  const auto openssl = [&](std::vector<std::string> words) {
    words.insert(words.begin(), "openssl");
    const Finished run = Run(words, kLimit);
    EXPECT_EQ(run.exit_code, 0) << run.error;
  };
  for (const char* name : {"ca", "robot"}) {
    openssl({"ecparam", "-name", "prime256v1", "-genkey", "-noout", "-out", at + name + ".key"});
  }
  openssl({"req", "-x509", "-new", "-key", at + "ca.key", "-days", "2", "-subj", "/CN=ca", "-out",
           at + "ca.pem"});
  openssl(
      {"req", "-new", "-key", at + "robot.key", "-subj", "/CN=robot", "-out", at + "robot.csr"});
  openssl({"x509", "-req", "-in", at + "robot.csr", "-CA", at + "ca.pem", "-CAkey", at + "ca.key",
           "-CAcreateserial", "-days", "2", "-out", at + "robot.pem"});
  folder.Write("governance.xml", kGovernance);
  folder.Write("permissions.xml", kPermissions);
  for (const char* name : {"governance", "permissions"}) {
    openssl({"smime", "-sign", "-in", at + name + ".xml", "-text", "-out", at + name + ".smime",
             "-signer", at + "ca.pem", "-inkey", at + "ca.key"});
  }
  std::string properties;
  const auto add = [&](const std::string& name, const std::string& value) {
    properties +=
        "<property><name>dds.sec." + name + "</name><value>" + value + "</value></property>\n";
  };
  const std::string auth = "auth.builtin.PKI-DH.";
  const std::string access = "access.builtin.Access-Permissions.";
  add("auth.plugin", "builtin.PKI-DH");
  add(auth + "identity_ca", "file://" + at + "ca.pem");
  add(auth + "identity_certificate", "file://" + at + "robot.pem");
  add(auth + "private_key", "file://" + at + "robot.key");
  add("access.plugin", "builtin.Access-Permissions");
  add(access + "permissions_ca", "file://" + at + "ca.pem");
  add(access + "governance", "file://" + at + "governance.smime");
  add(access + "permissions", "file://" + at + "permissions.smime");
  add("crypto.plugin", "builtin.AES-GCM-GMAC");
  std::string xml =
      config::ReadFile(std::string(SINEW_SOURCE_DIR) + "/components/topics/node/qos_profiles.xml");
  const std::string end = "</builtin>";
  const std::string more =
      "<propertiesPolicy><properties>" + properties + "</properties></propertiesPolicy>";
  for (std::size_t found = xml.find(end); found != std::string::npos;
       found = xml.find(end, found + more.size())) {
    xml.insert(found + end.size(), more);
  }
  return folder.Write("secure.xml", xml);
}

// The answer comes within a tenth of a second of the first announcement that is heard.
Finished Operate(const std::string& action, const std::vector<std::string>& more) {
  std::vector<std::string> words = {kSinew, action, "--domain", "165"};
  words.insert(words.end(), more.begin(), more.end());
  return testing::Run(words, kLimit);
}
// Longer than the half second between two announcements.
const std::vector<std::string> kStranger = {"--timeout", "2"};

TEST(Security, TheKeysOperateTheRobotAndWithoutThemNobodySeesIt) {
  const TemporaryFolder folder;
  const std::string profiles = MakeSecureProfiles(folder);
  const std::string deployment = folder.Write(
      "deploy.yaml",
      "schema: sinew-deployment/1\nname: one\ndomain_id: 165\nnetwork: {qos: secure.xml}\n"
      "provider: surrogate\nprocesses:\n  - {name: surrogate, program: sinew-surrogate}\n");
  Program launch({kSinew, "launch", deployment});
  const Finished armed = Operate("arm", {"--qos", profiles});
  EXPECT_EQ(armed.exit_code, 0) << armed.error << launch.error();

  const Finished stranger = Operate("disarm", kStranger);
  EXPECT_EQ(stranger.exit_code, 1);
  EXPECT_THAT(stranger.error, HasSubstr("no state provider heard in domain 165"));
  const Finished list = testing::Run({kSinew, "list", "--domain", "165"}, kLimit);
  EXPECT_THAT(list.output, HasSubstr("0 participants"));

  EXPECT_EQ(Operate("estop", {"--qos", profiles}).exit_code, 0);
  EXPECT_EQ(Operate("reset", {"--qos", profiles}).exit_code, 0);
  launch.Signal(SIGINT);
  EXPECT_EQ(launch.Wait(kLimit), 0) << launch.error();
}

// Keys of a deployment: datagrams without their tag are not read.
std::string MakeKey(const TemporaryFolder& folder, const std::string& name, char digit) {
  const std::string file = folder.Write(name, std::string(64, digit) + "\n");
  std::filesystem::permissions(file, std::filesystem::perms::owner_read);
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
  const std::string profiles = MakeSecureProfiles(folder);
  const std::string key = MakeKey(folder, "deployment.key", 'a');
  Program surrogate(
      hosts.On(0, {std::string(SINEW_BIN_DIR) + "/sinew-surrogate", "--domain", "166", "--qos",
                   profiles, "--key", key, "--interface", "wire0", "--open", "wire0"}));
  const auto estop = [&](int host, const std::vector<std::string>& more) {
    std::vector<std::string> words = {kSinew, "estop", "--domain", "166", "--qos", profiles};
    words.insert(words.end(), more.begin(), more.end());
    return testing::Run(hosts.On(host, words), kLimit).exit_code;
  };
  EXPECT_EQ(estop(1, {"--interface", "wire0"}), 0) << surrogate.error();
  EXPECT_EQ(estop(0, {"--key", key}), 0) << surrogate.error();
  EXPECT_EQ(estop(0, kStranger), 1);
}

}  // namespace
}  // namespace sinew::testing
