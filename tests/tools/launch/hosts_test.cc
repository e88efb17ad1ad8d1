// A deployment over several hosts: each starts its part of the same file.
#include "tools/launch/hosts.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "components/base/config/config.h"
#include "components/topics/node/host_name.h"
#include "tests/support/temporary_folder.h"
#include "tools/launch/deployment.h"

namespace sinew::launch {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

// The interface that every machine has; on the desk one that this machine has not.
constexpr char kHosts[] =
    "hosts:\n"
    "  - {name: robot, interface: lo}\n"
    "  - {name: desk, interface: nowhere0}\n"
    "  - {name: screen, interface: lo}\n";
constexpr char kProcesses[] =
    "provider: plant\n"
    "processes:\n"
    "  - {name: plant, program: sinew-plant}\n"
    "  - {name: logger, program: sinew-logger, arguments: [--out, old.mcap], host: robot}\n"
    "  - {name: control, program: sinew-there, config: there.yaml, host: desk}\n"
    "  - {name: esn, program: sinew-there, host: desk, after: [control]}\n";

class HostsTest : public ::testing::Test {
 protected:
  HostsTest() {
    for (const char* name : {"bin/sinew-plant", "bin/sinew-logger"}) {
      std::filesystem::permissions(folder_.Write(name, "#!/bin/sh\n"),
                                   std::filesystem::perms::owner_all);
    }
  }

  Deployment Load(const Overrides& overrides, const std::string& hosts = kHosts,
                  const std::string& processes = kProcesses) {
    return LoadDeployment(
        folder_.Write("deploy.yaml", "schema: sinew-deployment/1\n" + hosts + processes), overrides,
        folder_.path() / "bin");
  }

  std::string ErrorOf(const Overrides& overrides, const std::string& hosts = kHosts,
                      const std::string& processes = kProcesses) {
    try {
      Load(overrides, hosts, processes);
    } catch (const UsageError& error) {
      return error.what();
    }
    return "no error";
  }

  static Overrides On(const std::string& host) {
    Overrides overrides;
    overrides.host = host;
    return overrides;
  }
  static std::vector<std::string> Names(const std::vector<Process>& processes) {
    std::vector<std::string> names;
    for (const Process& process : processes) names.push_back(process.name);
    return names;
  }

  testing::TemporaryFolder folder_;
};

TEST_F(HostsTest, EachStartsItsPartAndAProcessWithoutAHostIsOfTheFirstOne) {
  const Deployment robot = Load(On("robot"));
  EXPECT_THAT(Names(robot.processes), ElementsAre("plant", "logger"));
  EXPECT_THAT(Names(robot.elsewhere), ElementsAre("control", "esn"));
  EXPECT_THAT(robot.interfaces, ElementsAre("lo"));
  EXPECT_FALSE(robot.provider_elsewhere());
  const std::vector<std::string> line = CommandLine(robot, robot.processes[0]);
  EXPECT_EQ(std::count(line.begin(), line.end(), "--interface"), 1);
}

TEST_F(HostsTest, WithoutAHostItIsTheMachineOfThatName) {
  const std::string machine = node::HostName();
  const std::string named =
      "hosts: [{name: other, interface: nowhere0}, {name: " + machine + ", interface: lo}]\n";
  const std::string process = "processes: [{name: plant, program: sinew-plant, host: " + machine +
                              "}, {name: away, program: sinew-there}]\n";
  EXPECT_THAT(Names(Load({}, named, process).processes), ElementsAre("plant"));
  EXPECT_THAT(ErrorOf({}), AllOf(HasSubstr("deploy.yaml: hosts: this machine, '" + machine + "'"),
                                 HasSubstr("--host with one of robot, desk, screen, or all")));
}

TEST_F(HostsTest, AllOfThemOnOneMachineAreOnLoopback) {
  EXPECT_THAT(ErrorOf(On("all")), HasSubstr("no program 'sinew-there'")) << "they start here";
  const Deployment all = Load(On("all"), kHosts,
                              "processes:\n  - {name: plant, program: sinew-plant}\n"
                              "  - {name: logger, program: sinew-logger, host: desk}\n");
  EXPECT_THAT(Names(all.processes), ElementsAre("plant", "logger"));
  EXPECT_THAT(all.interfaces, IsEmpty());
  EXPECT_THAT(all.elsewhere, IsEmpty());
}

TEST_F(HostsTest, WhatIsWrongIsOneLineThatNamesFileAndKey) {
  EXPECT_THAT(ErrorOf(On("dsek")), HasSubstr("--host dsek: expected one of robot, desk, screen"));
  EXPECT_THAT(ErrorOf(On("desk")), HasSubstr("hosts: desk: no interface 'nowhere0'"));
  EXPECT_THAT(ErrorOf(On("robot"), "", "processes: [{name: plant, program: sinew-plant}]\n"),
              HasSubstr("--host robot: "));
  EXPECT_THAT(ErrorOf({}, "", kProcesses), HasSubstr("expected 'hosts' in this file"));
  const struct {
    const char *hosts, *processes, *error;
  } kCases[] = {
      {"hosts: [{name: robot}]\n", kProcesses, "interface': missing"},
      {"hosts: [{name: all, interface: lo}]\n", kProcesses, "'all', expected a host's name"},
      {"hosts: [{name: robot, interface: lo}, {name: robot, interface: lo}]\n", kProcesses,
       "'robot' given twice"},
      {"hosts: [{name: robot, interface: lo, colour: red}]\n",
       "processes: [{name: a, program: sinew-plant}]\n", "colour"},
      {"hosts: [{name: robot, interface: lo}]\nnetwork: {interfaces: [lo]}\n", kProcesses,
       "each of the 'hosts' names its own interface"},
      {kHosts, "processes: [{name: a, program: sinew-plant, host: dsek}]\n",
       "'dsek', expected one of robot, desk, screen"},
      {kHosts,
       "processes: [{name: a, program: sinew-plant}, "
       "{name: b, program: sinew-there, host: desk, after: [a]}]\n",
       "'a' is of another host, expected one of host 'desk'"},
      {kHosts, "processes: [{name: a, program: sinew-there, host: desk}]\n",
       "processes: none is of host 'robot'"},
      {"hosts: [{name: robot, interface: lo}]\nnetwork: {isolate: true}\n",
       "processes: [{name: a, program: sinew-plant}]\n",
       "without 'lo', expected it: an isolated deployment"},
      {kHosts,
       "provider: a\nprocesses: [{name: a, program: sinew-there, host: desk, vital: false}, "
       "{name: b, program: sinew-plant}]\n",
       "'a' has vital: false"},
  };
  for (const auto& wrong : kCases) {
    EXPECT_THAT(ErrorOf(On("robot"), wrong.hosts, wrong.processes),
                AllOf(HasSubstr("deploy.yaml"), HasSubstr(wrong.error)));
  }
}

TEST_F(HostsTest, OverridesAreForThisHostsProcesses) {
  Overrides overrides = On("robot");
  overrides.without = {"control"};
  EXPECT_THAT(ErrorOf(overrides), HasSubstr("deploy.yaml on host robot: plant, logger"));
}

TEST_F(HostsTest, TheProvidersOptionsAreGivenWhereItRuns) {
  Overrides overrides = On("screen");
  overrides.record = "run.mcap";
  const Deployment screen = Load(overrides);
  EXPECT_TRUE(screen.provider_elsewhere());
  EXPECT_THAT(Names(screen.processes), ElementsAre("logger_screen")) << "the robot's has its own";
  overrides.settings = {"duration_s=5"};
  EXPECT_THAT(ErrorOf(overrides), HasSubstr("where the provider 'plant' runs"));
  overrides.settings = {"mode=lockstep"};
  EXPECT_THAT(ErrorOf(overrides), HasSubstr("--record run.mcap: expected it where the provider"));
}

TEST_F(HostsTest, InLockstepTheProviderWaitsForLoggersOfOtherHosts) {
  const Deployment robot = Load(On("robot"), kHosts,
                                "mode: lockstep\nprovider: plant\nawait: [joint_command]\n"
                                "processes:\n  - {name: plant, program: sinew-plant}\n"
                                "  - {name: logger, program: sinew-logger, host: desk}\n");
  EXPECT_THAT(CommandLine(robot, robot.processes[0]),
              Contains("joint_command,recording_progress:64"));
}

TEST_F(HostsTest, ProcessesOfAnotherUserAreRefused) {
  RequireUser({"robot", "lo", ""}, "deploy.yaml");
  EXPECT_THROW(RequireUser({"robot", "lo", "no-such-user"}, "deploy.yaml"), UsageError);
}

}  // namespace
}  // namespace sinew::launch
