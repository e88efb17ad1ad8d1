// A deployment in a network of its own: its user's programs find and enter it, nobody else does.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "tests/support/program.h"
#include "tests/support/sinew_program.h"
#include "tests/support/skip.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test_host.h"
#include "tests/tools/view/view_program.h"

namespace sinew::testing {
namespace {

using namespace std::chrono_literals;
namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr auto kLimit = 30s;
const std::vector<std::string> kStranger = {"--timeout", "2"};

std::string Deployment(const TemporaryFolder& folder, const std::string& name, int domain,
                       const std::string& more = "") {
  return folder.Write(name + ".yaml",
                      "schema: sinew-deployment/1\nname: " + name + "\ndomain_id: " +
                          std::to_string(domain) + "\nnetwork: {isolate: true" + more +
                          "}\nprovider: surrogate\nprocesses:\n"
                          "  - {name: surrogate, program: sinew-surrogate}\n"
                          "  - name: foreign\n    program: /bin/sh\n    plain: true\n"
                          "    vital: false\n    arguments: [-c, 'ip -br link; exec sleep 100']\n");
}

// As in a shell, where no launcher has said which deployment is meant.
std::vector<std::string> Shell(std::vector<std::string> line) {
  line.insert(line.begin(), {"env", "-u", "SINEW_DEPLOYMENT", kSinew});
  return line;
}

// The program lies where another user may read it, as an installed one does.
std::vector<std::string> OfAnotherUser(const TemporaryFolder& folder,
                                       const std::vector<std::string>& line) {
  const fs::path installed = folder.path() / "sinew";
  fs::copy_file(kSinew, installed, fs::copy_options::skip_existing);
  fs::permissions(folder.path(), fs::perms(0755));
  std::vector<std::string> out = {
      "setpriv", "--reuid=65534",    "--regid=65534",   "--clear-groups", "env",
      "-u",      "SINEW_DEPLOYMENT", installed.string()};
  out.insert(out.end(), line.begin(), line.end());
  return out;
}

Finished In(const std::vector<std::string>& line, const std::vector<std::string>& more = {}) {
  std::vector<std::string> words = line;
  words.insert(words.end(), more.begin(), more.end());
  return testing::Run(words, kLimit);
}

bool Stop(Program* launch) {
  launch->Signal(SIGINT);
  return launch->Wait(kLimit) == 0;
}

TEST(Isolation, ItsUsersProgramsEnterByThemselvesAndNobodyElseHearsIt) {
  SKIP_WITHOUT_KERNEL(::geteuid() == 0, "another user is tried, which needs root");
  const TemporaryFolder folder;
  Program launch({kSinew, "launch", Deployment(folder, "isolated", 167)});
  ASSERT_TRUE(launch.WaitForText("lo ", kLimit)) << launch.error();
  EXPECT_THAT(launch.output(), Not(HasSubstr("eth"))) << "a foreign program is inside as well";
  const Finished armed = In(Shell({"arm", "--domain", "167"}));
  EXPECT_EQ(armed.exit_code, 0) << armed.error << launch.error();
  EXPECT_THAT(In(Shell({"doctor", "--domain", "167", "--wait", "1.2", "--recordings", "/"})).output,
              HasSubstr("in the network of deployment 'isolated' its user and root, and nobody"));

  // Files of shared memory are apart as well.
  const fs::path outside_file = "/dev/shm/sinew-isolation-" + std::to_string(::getpid());
  std::ofstream(outside_file) << "of the host";
  const Finished shared = In(Shell({"enter", "isolated", "stat", "-f", "-c", "%T", "/dev/shm"}));
  EXPECT_EQ(shared.output, "tmpfs\n") << shared.error;
  EXPECT_NE(In(Shell({"enter", "isolated", "stat", outside_file.string()})).exit_code, 0);
  EXPECT_TRUE(fs::remove(outside_file));

  // The host's own network, and another user of the host.
  const Finished outside =
      In(Shell({"disarm", "--domain", "167", "--deployment", "none"}), kStranger);
  EXPECT_THAT(outside.error, HasSubstr("no state provider heard in domain 167; isolated there: "
                                       "'isolated' (--deployment isolated)"));
  EXPECT_THAT(In(OfAnotherUser(folder, {"disarm", "--domain", "167"}), kStranger).error,
              HasSubstr("no state provider heard in domain 167; isolated there: 'isolated' of user "
                        "root, whose programs alone reach it"));
  EXPECT_EQ(In(Shell({"estop", "--domain", "167"})).exit_code, 0);
  EXPECT_TRUE(Stop(&launch)) << launch.error();
}

TEST(Isolation, TheLivePageIsReachedFromTheHost) {
  SKIP_WITHOUT_PACKAGE(testing::Run({"node", "--version"}).exit_code == 0, "nodejs");
  const TemporaryFolder folder;
  Program launch({kSinew, "launch", Deployment(folder, "seen", 167)});
  ASSERT_TRUE(launch.WaitForText("surrogate |", kLimit)) << launch.error();
  View view({"--domain", "167", "--deployment", "seen"});
  const Finished client = view.Ask({"receive", "100"});
  EXPECT_EQ(client.exit_code, 0) << client.error << view.log();
  EXPECT_EQ(view.End(), 0) << view.log();
  EXPECT_TRUE(Stop(&launch)) << launch.error();
}

TEST(Isolation, OfSeveralOneIsNamed) {
  const TemporaryFolder folder;
  Program first({kSinew, "launch", Deployment(folder, "one", 168)});
  ASSERT_TRUE(first.WaitForText("surrogate |", kLimit)) << first.error();
  Program second({kSinew, "launch", Deployment(folder, "two", 168)});
  ASSERT_TRUE(second.WaitForText("surrogate |", kLimit)) << second.error();
  const Finished unclear = In(Shell({"estop", "--domain", "168"}));
  EXPECT_EQ(unclear.exit_code, 2);
  EXPECT_THAT(unclear.error, AllOf(HasSubstr("several isolated deployments"),
                                   HasSubstr("--deployment with one of one, two")));
  EXPECT_THAT(In(Shell({"estop", "--domain", "168", "--deployment", "three"})).error,
              HasSubstr("expected one of this user's: one, two"));
  EXPECT_EQ(In(Shell({"estop", "--domain", "168", "--deployment", "two"})).exit_code, 0);
  // The other one did not hear of it.
  EXPECT_EQ(In(Shell({"arm", "--domain", "168", "--deployment", "one"})).exit_code, 0);
  const Finished again = In({kSinew, "isolate", "one", "--domain", "0"});
  EXPECT_EQ(again.exit_code, 2);
  EXPECT_THAT(again.error, HasSubstr("a deployment 'one' runs already"));
  EXPECT_TRUE(Stop(&first)) << first.error();
  EXPECT_TRUE(Stop(&second)) << second.error();
}

TEST(Isolation, AnInterfaceMovesInAndComesBack) {
  const TestHost host;
  SKIP_WITHOUT_KERNEL(host.why_not().empty(), host.why_not());
  const auto on_host = [&host](const std::vector<std::string>& line) {
    return testing::Run(host.Line(line), kLimit);
  };
  ASSERT_EQ(
      on_host({"ip", "link", "add", "bus0", "type", "veth", "peer", "name", "bus1"}).exit_code, 0);
  ASSERT_EQ(on_host({"ip", "addr", "add", "10.9.0.1/24", "dev", "bus0"}).exit_code, 0);
  ASSERT_EQ(on_host({"ip", "link", "set", "bus0", "up"}).exit_code, 0);
  const TemporaryFolder folder;
  Program launch(host.Line({kSinew, "launch", Deployment(folder, "moved", 169, ", move: [bus0]")}));
  ASSERT_TRUE(launch.WaitForText("surrogate |", kLimit)) << launch.error();
  EXPECT_THAT(on_host({"ip", "-br", "link"}).output, Not(HasSubstr("bus0@")));
  EXPECT_THAT(on_host({kSinew, "enter", "moved", "ip", "-br", "link"}).output,
              AllOf(HasSubstr("bus0@"), HasSubstr("UP>")));
  EXPECT_THAT(on_host({kSinew, "enter", "moved", "ip", "-br", "addr", "show", "bus0"}).output,
              HasSubstr("10.9.0.1/24"));
  EXPECT_TRUE(Stop(&launch)) << launch.error();
  EXPECT_THAT(on_host({"ip", "-br", "link", "show", "bus0"}).output, HasSubstr(",UP"));
  EXPECT_THAT(on_host({"ip", "-br", "addr", "show", "bus0"}).output, HasSubstr("10.9.0.1/24"));
}

}  // namespace
}  // namespace sinew::testing
