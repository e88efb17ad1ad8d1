#include "tools/launch/deployment.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "components/base/config/config.h"
#include "tests/support/temporary_folder.h"
#include "tools/launch/deployment_files.h"

namespace sinew::launch {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr char kTwo[] =
    "schema: sinew-deployment/1\n"
    "name: two\n"
    "domain_id: 7\n"
    "mode: lockstep\n"
    "duration_s: 2.5\n"
    "seed: 9\n"
    "provider: plant\n"
    "await: [joint_command]\n"
    "processes:\n"
    "  - name: plant\n"
    "    program: sinew-plant\n"
    "    config: plant.yaml\n"
    "    arguments: [--effect, stribeck]\n"
    "  - name: logger\n"
    "    program: sinew-logger\n"
    "    arguments: [--out, old.mcap]\n"
    "    after: [plant]\n"
    "    restart: on_failure\n"
    "    max_restarts: 2\n"
    "    back_off_s: 0.25\n";

class DeploymentTest : public ::testing::Test {
 protected:
  DeploymentTest() {
    for (const char* name :
         {"bin/sinew-plant", "bin/sinew-logger", "bin/sinew-control", "bin/sinew-compose",
          "bin/sinew-surrogate", "bin/sinew-esn", "bin/sinew-inverse-dynamics"}) {
      std::filesystem::permissions(folder_.Write(name, "#!/bin/sh\n"),
                                   std::filesystem::perms::owner_all);
    }
    folder_.Write("plant.yaml", "");
    other_ = folder_.Write("other.yaml", "");
  }

  Deployment Load(const std::string& text, const Overrides& overrides = {}) {
    return LoadDeployment(folder_.Write("deploy.yaml", text), overrides, folder_.path() / "bin");
  }

  std::string ErrorOf(const std::string& text, const Overrides& overrides = {}) {
    try {
      Load(text, overrides);
    } catch (const UsageError& error) {
      return error.what();
    }
    return "no error";
  }

  // kTwo with one piece of text replaced.
  static std::string Changed(const std::string& from, const std::string& to) {
    std::string text = kTwo;
    return text.replace(text.find(from), from.size(), to);
  }

  testing::TemporaryFolder folder_;
  std::string other_;
};

TEST_F(DeploymentTest, ReadsWhatTheFileSays) {
  const Deployment two = Load(kTwo);
  EXPECT_EQ(two.name, "two");
  EXPECT_EQ(two.domain_id, 7);
  EXPECT_TRUE(two.lockstep);
  EXPECT_EQ(two.duration_s, 2.5);
  EXPECT_EQ(two.seed, 9u);
  EXPECT_EQ(two.provider, "plant");
  ASSERT_EQ(two.processes.size(), 2u);
  EXPECT_EQ(two.processes[0].program, folder_.path() / "bin/sinew-plant");
  EXPECT_EQ(two.processes[0].config, folder_.path() / "plant.yaml");
  EXPECT_EQ(two.processes[0].restart, Restart::kNever);
  EXPECT_FALSE(two.processes[0].stop_last);
  EXPECT_THAT(two.processes[1].after, ElementsAre("plant"));
  EXPECT_EQ(two.processes[1].restart, Restart::kOnFailure);
  EXPECT_EQ(two.processes[1].max_restarts, 2);
  EXPECT_EQ(two.processes[1].back_off_s, 0.25);
  EXPECT_TRUE(two.processes[1].stop_last) << "a logger stops last by default";
}

TEST_F(DeploymentTest, CommandLinesCarryTheCommonOptionsThenTheirOwn) {
  const Deployment two = Load(kTwo);
  EXPECT_THAT(
      CommandLine(two, two.processes[0]),
      ElementsAre((folder_.path() / "bin/sinew-plant").string(), "--name", "plant", "--domain", "7",
                  "--seed", "9", "--interface", "lo", "--lockstep", "--config",
                  (folder_.path() / "plant.yaml").string(), "--duration", "2.5", "--await",
                  "joint_command,recording_progress:64", "--effect", "stribeck"));
  EXPECT_THAT(
      CommandLine(two, two.processes[1]),
      ElementsAre((folder_.path() / "bin/sinew-logger").string(), "--name", "logger", "--domain",
                  "7", "--seed", "9", "--interface", "lo", "--lockstep", "--note", "deployment=two",
                  "--attach", "deploy.yaml=" + (folder_.path() / "deploy.yaml").string(),
                  "--attach", "plant.yaml=" + (folder_.path() / "plant.yaml").string(), "--out",
                  "old.mcap"));
}

TEST_F(DeploymentTest, ALoggerGetsEveryFileThatTheDeploymentNames) {
  folder_.Write("plant.yaml",
                "model: models/rig.yaml\nother: [missing.yaml, {a: weights.bin}]\n"
                "from: old.mcap\nself: plant.yaml\n");
  folder_.Write("models/rig.yaml",
                "urdf: rig.urdf\nbroken: ../broken.yaml\nin_itself: ../loop.yaml\n");
  folder_.Write("models/rig.urdf", "<robot/>");
  folder_.Write("broken.yaml", "a: [\n");
  folder_.Write("loop.yaml", "a: &a [*a]\n");
  folder_.Write("weights.bin", "w");
  folder_.Write("old.mcap", "a recording is no configuration");
  std::vector<std::string> names;
  for (const DeploymentFile& file : FilesOf(Load(kTwo))) {
    EXPECT_TRUE(std::filesystem::equivalent(file.path, folder_.path() / file.name)) << file.name;
    names.push_back(file.name);
  }
  EXPECT_THAT(names, ElementsAre("deploy.yaml", "plant.yaml", "models/rig.yaml", "models/rig.urdf",
                                 "broken.yaml", "loop.yaml", "weights.bin"));
  Overrides overrides;
  overrides.without = {"logger"};
  EXPECT_TRUE(Load(kTwo, overrides).attachments.empty()) << "nobody records";
}

TEST_F(DeploymentTest, KeysAreNotAttachedToRecordings) {
  folder_.Write("robot.secret", "5a");
  folder_.Write("other.key", "5a");
  const Deployment named =
      Load(Changed("domain_id: 7\n", "domain_id: 7\nnetwork: {key: robot.secret}\n"));
  EXPECT_EQ(named.key.filename(), "robot.secret");
  for (const DeploymentFile& file : FilesOf(named)) EXPECT_NE(file.name, "robot.secret");
  const Deployment argument =
      Load(Changed("[--out, old.mcap]",
                   "[--out, old.mcap, --key, " + (folder_.path() / "other.key").string() + "]"));
  for (const DeploymentFile& file : FilesOf(argument)) EXPECT_NE(file.name, "other.key");
}

TEST_F(DeploymentTest, EveryProcessGetsTheCertificateOfItsName) {
  const Deployment named =
      Load(Changed("domain_id: 7\n", "domain_id: 7\nnetwork: {security: keys}\n"));
  const std::string keys = (folder_.path() / "keys").string();
  for (const Process& process : named.processes) {
    const std::vector<std::string> line = CommandLine(named, process);
    const auto at = std::find(line.begin(), line.end(), "--qos");
    ASSERT_NE(at, line.end()) << process.name;
    EXPECT_EQ(*std::next(at), keys + "/" + process.name + "/qos.xml");
  }
  try {
    CheckCertificates(named);
    FAIL() << "nobody has a certificate";
  } catch (const UsageError& error) {
    EXPECT_THAT(error.what(), HasSubstr("keys/plant/qos.xml: no certificate of process 'plant'"));
  }
  for (const char* name : {"plant", "logger"}) {
    folder_.Write("keys/" + std::string(name) + "/qos.xml", "");
  }
  CheckCertificates(named);
  EXPECT_THAT(ErrorOf(Changed("domain_id: 7\n",
                              "domain_id: 7\nnetwork: {security: keys, qos: plant.yaml}\n")),
              HasSubstr("given with 'security'"));
}

TEST_F(DeploymentTest, ComposedProcessesShareACertificateOfTheirOwn) {
  std::string text = Changed("mode: lockstep", "mode: realtime");
  text.replace(text.find("domain_id: 7\n"), 13, "domain_id: 7\nnetwork: {security: keys}\n");
  text += "  - {name: control, program: sinew-control}\n";
  Overrides overrides;
  overrides.compose = {"control"};
  const Deployment composed = Load(text, overrides);
  EXPECT_EQ(QosOf(composed, composed.Find("plant")->certificate),
            folder_.path() / "keys/compose/qos.xml");
}

TEST_F(DeploymentTest, NamedInterfacesAreHandedToEveryProgram) {
  Overrides overrides;
  const Deployment named =
      Load(Changed("domain_id: 7\n", "domain_id: 7\nnetwork: {interfaces: [lo]}\n"));
  EXPECT_THAT(named.interfaces, ElementsAre("lo"));
  overrides.settings = {"interfaces=lo,lo"};
  const Deployment two = Load(kTwo, overrides);
  for (const Process& process : two.processes) {
    const std::vector<std::string> line = CommandLine(two, process);
    EXPECT_EQ(std::count(line.begin(), line.end(), "--interface"), 2) << process.name;
  }
}

TEST_F(DeploymentTest, ADiscoveryServerIsAnAddressAndAPort) {
  const auto with = [](const std::string& network) {
    return Changed("domain_id: 7\n", "domain_id: 7\nnetwork: {" + network + "}\n");
  };
  EXPECT_EQ(Load(with("discovery_server: '10.0.0.1:11811'")).discovery_server, "10.0.0.1:11811");
  for (const char* wrong : {"10.0.0.1", "robot:11811", "10.0.0.1:", "10.0.0.1:0", "10.0.0.1:70000",
                            "10.0.0.1:11811x"}) {
    EXPECT_THAT(ErrorOf(with("discovery_server: '" + std::string(wrong) + "'")),
                HasSubstr("'network.discovery_server': '" + std::string(wrong) +
                          "', expected an IPv4 address and a port"));
  }
  folder_.Write("robot.key", "");
  EXPECT_THAT(ErrorOf(with("discovery_server: '10.0.0.1:11811', key: robot.key")),
              HasSubstr("expected no 'key' beside it"));
}

TEST_F(DeploymentTest, QosProfilesAreHandedToEveryProgram) {
  const Deployment named =
      Load(Changed("domain_id: 7\n", "domain_id: 7\nnetwork: {qos: plant.yaml}\n"));
  for (const Process& process : named.processes) {
    const std::vector<std::string> line = CommandLine(named, process);
    const auto at = std::find(line.begin(), line.end(), "--qos");
    ASSERT_NE(at, line.end()) << process.name;
    EXPECT_THAT(*std::next(at), ::testing::EndsWith("/plant.yaml"));
  }
  const Deployment other = Load(kTwo);
  EXPECT_THAT(CommandLine(other, other.processes[0]), ::testing::Not(::testing::Contains("--qos")));
}

TEST_F(DeploymentTest, PlainProgramsGetTheirOwnArgumentsOnly) {
  const Deployment two =
      Load(Changed("    arguments: [--effect, stribeck]\n", "    plain: true\n"));
  EXPECT_THAT(CommandLine(two, two.processes[0]),
              ElementsAre((folder_.path() / "bin/sinew-plant").string()));
}

TEST_F(DeploymentTest, OverridesChangeWhatTheFileSays) {
  Overrides overrides;
  overrides.settings = {"mode=realtime", "duration_s=0",           "seed=3",
                        "domain_id=11",  "plant.config=" + other_, "plant.restart=always"};
  overrides.arguments = {"plant=--scale=2=3"};
  overrides.record = "new.mcap";
  const Deployment two = Load(kTwo, overrides);
  EXPECT_THAT(CommandLine(two, two.processes[0]),
              ElementsAre((folder_.path() / "bin/sinew-plant").string(), "--name", "plant",
                          "--domain", "11", "--seed", "3", "--interface", "lo", "--config", other_,
                          "--effect", "stribeck", "--scale=2=3"));
  EXPECT_EQ(two.processes[0].restart, Restart::kAlways);
  EXPECT_THAT(two.processes[1].arguments,
              ElementsAre("--out", (std::filesystem::current_path() / "new.mcap").string()));
}

TEST_F(DeploymentTest, LoggersAreNoReasonToStopARobotInRealTime) {
  const Deployment lockstep = Load(kTwo);
  EXPECT_TRUE(lockstep.processes[1].vital) << "the provider waits for it";
  Overrides overrides;
  overrides.without = {"logger"};
  overrides.settings = {"mode=realtime"};
  overrides.record = folder_.path() / "run.mcap";
  const Deployment two = Load(kTwo, overrides);
  ASSERT_EQ(two.processes.size(), 2u);
  EXPECT_TRUE(two.processes[0].vital);
  EXPECT_FALSE(two.processes[1].vital);
  EXPECT_EQ(two.processes[1].restart, Restart::kOnFailure);
  EXPECT_THAT(CommandLine(two, two.processes[1]), Contains((folder_.path() / "run.mcap").string()));
  EXPECT_THAT(CommandLine(two, two.processes[1], 2),
              Contains((folder_.path() / "run-3.mcap").string()))
      << "what was recorded before is not overwritten";
}

TEST_F(DeploymentTest, AProviderIsAlwaysVital) {
  EXPECT_THAT(ErrorOf(Changed("    config: plant.yaml\n", "    vital: false\n")),
              AllOf(HasSubstr("'plant'"), HasSubstr("vital: false")));
}

TEST_F(DeploymentTest, RecordAddsALoggerWhereThereIsNone) {
  Overrides overrides;
  overrides.without = {"logger"};
  const Deployment alone = Load(kTwo, overrides);
  ASSERT_EQ(alone.processes.size(), 1u);
  EXPECT_THAT(CommandLine(alone, alone.processes[0]), Contains("joint_command"))
      << "no logger, no waiting for one";
  overrides.record = "/new.mcap";
  const Deployment two = Load(kTwo, overrides);
  ASSERT_EQ(two.processes.size(), 2u);
  EXPECT_EQ(two.processes[1].name, "logger");
  EXPECT_TRUE(two.processes[1].stop_last);
  EXPECT_THAT(two.processes[1].arguments, ElementsAre("--out", "/new.mcap"));
  overrides.overwrite = true;
  EXPECT_THAT(Load(kTwo, overrides).processes[1].arguments,
              ElementsAre("--out", "/new.mcap", "--overwrite"));
}

TEST_F(DeploymentTest, LeavingAProcessOutAlsoRemovesTheWaitForIt) {
  std::string text = Changed("    after: [plant]\n", "");
  const std::string program = "    program: sinew-plant\n";
  text.insert(text.find(program) + program.size(), "    after: [logger]\n");
  EXPECT_THAT(Load(text).processes[0].after, ElementsAre("logger"));
  Overrides overrides;
  overrides.without = {"logger"};
  EXPECT_TRUE(Load(text, overrides).processes[0].after.empty());
}

TEST_F(DeploymentTest, WhatOnlyAProcessThatIsLeftOutWroteIsNotAwaited) {
  const std::string chain =
      "schema: sinew-deployment/1\nname: chain\nmode: lockstep\nduration_s: 1\n"
      "provider: plant\nawait: [joint_command, \"torque_prediction:64\"]\nprocesses:\n"
      "  - {name: plant, program: sinew-surrogate}\n  - {name: control, program: sinew-control}\n"
      "  - {name: esn, program: sinew-esn}\n";
  Overrides overrides;
  overrides.without = {"esn"};
  EXPECT_THAT(Load(chain, overrides).await, ElementsAre("joint_command"));
  const std::string stand_in = "  - {name: other, program: sinew-inverse-dynamics}\n";
  EXPECT_THAT(Load(chain + stand_in, overrides).await, Contains("torque_prediction:64"));
  const std::string foreign = "  - {name: other, program: sinew-plant}\n";
  EXPECT_THAT(Load(chain + foreign, overrides).await, Contains("torque_prediction:64"))
      << "a program that may write it";
}

struct BadFile {
  std::string from, to;
  std::vector<std::string> words;  // of the message: line, key, what was expected
};

class BadDeployment : public DeploymentTest, public ::testing::WithParamInterface<BadFile> {};

TEST_F(DeploymentTest, ComposedProcessesRunInTheProvidersThread) {
  const std::string text = std::string(kTwo) +
                           "  - name: pid\n    program: sinew-control\n    config: other.yaml\n"
                           "  - name: watch\n    program: sinew-control\n    arguments: [--x]\n";
  Overrides overrides;
  overrides.compose = {"pid"};
  EXPECT_THAT(ErrorOf(text, overrides), HasSubstr("--compose pid: expected mode realtime"));
  overrides.settings = {"mode=realtime"};
  const Deployment composed = Load(text, overrides);
  EXPECT_EQ(composed.Find("pid"), nullptr);
  const Process* plant = composed.Find("plant");
  ASSERT_NE(plant, nullptr);
  EXPECT_EQ(plant->program.filename(), "sinew-compose");
  EXPECT_THAT(plant->arguments, ElementsAre("--provider", "sinew-plant", "--effect", "stribeck",
                                            "--component", "pid=sinew-control=" + other_));
  overrides.compose.clear();
  overrides.compose_all = true;  // one with arguments of its own stays a process
  EXPECT_NE(Load(text, overrides).Find("watch"), nullptr);
  EXPECT_EQ(Load(text, overrides).Find("pid"), nullptr);
  overrides.compose = {"watch"};
  overrides.compose_all = false;
  EXPECT_THAT(ErrorOf(text, overrides), HasSubstr("'watch' has some"));
}

TEST_P(BadDeployment, IsRefusedInOneLineWithLineKeyAndWhatWasExpected) {
  const std::string message = ErrorOf(Changed(GetParam().from, GetParam().to));
  EXPECT_THAT(message, HasSubstr("deploy.yaml:"));
  EXPECT_THAT(message, HasSubstr("expected"));
  EXPECT_THAT(message, Not(HasSubstr("\n")));
  for (const std::string& word : GetParam().words) EXPECT_THAT(message, HasSubstr(word));
}

INSTANTIATE_TEST_SUITE_P(
    Keys, BadDeployment,
    ::testing::Values(
        BadFile{"seed: 9", "sead: 9", {":6:", "'sead'", "unknown"}},
        BadFile{"back_off_s: 0.25", "back_off_ms: 250", {":20:", "wrong unit", "back_off_s"}},
        BadFile{"duration_s: 2.5", "duration_s: .nan", {":5:", "duration_s"}},
        BadFile{"duration_s: 2.5", "duration_s: -1", {":5:", "duration_s"}},
        BadFile{"domain_id: 7", "domain_id: 233", {":3:", "domain_id", "232"}},
        BadFile{"domain_id: 7",
                "network: {interfaces: [nowhere0]}",
                {":3:", "network.interfaces", "'nowhere0'", "lo"}},
        BadFile{
            "domain_id: 7", "network: {interface: lo}", {":3:", "'network.interface'", "unknown"}},
        BadFile{"mode: lockstep", "mode: fast", {":4:", "realtime, lockstep"}},
        BadFile{"provider: plant", "provider: robot", {":7:", "'robot'", "name of a process"}},
        BadFile{"program: sinew-plant", "program: sinew-plan", {":11:", "'sinew-plan'", "PATH"}},
        BadFile{"program: sinew-plant", "program: ./plant", {":11:", "'./plant'"}},
        BadFile{"after: [plant]", "after: [plan]", {":17:", "'plan'"}},
        BadFile{"after: [plant]", "after: [logger]", {":17:", "circle"}},
        BadFile{"name: logger", "name: plant", {"twice"}},
        BadFile{"name: logger", "name: a b", {"'a b'"}},
        BadFile{"restart: on_failure", "restart: often", {":18:", "on_failure"}},
        BadFile{"max_restarts: 2", "max_restarts: 2.5", {":19:", "whole number"}},
        BadFile{"sinew-deployment/1", "sinew-deployment/9", {":1:", "sinew-deployment/1"}}));

TEST_F(DeploymentTest, AMissingConfigurationIsNamedWithItsPath) {
  const std::string message = ErrorOf(Changed("config: plant.yaml", "config: nowhere.yaml"));
  EXPECT_THAT(message, AllOf(HasSubstr(":12: key 'processes[0].config'"),
                             HasSubstr((folder_.path() / "nowhere.yaml").string())));
}

TEST_F(DeploymentTest, AMissingFileIsNamed) {
  EXPECT_THROW(LoadDeployment("/nowhere/deploy.yaml", {}, ""), UsageError);
}

TEST_F(DeploymentTest, AnEmptyListIsRefused) {
  EXPECT_THAT(ErrorOf("schema: sinew-deployment/1\nprocesses: []\n"),
              HasSubstr("expected 1 or more"));
}

struct BadOverride {
  Overrides overrides;
  std::string word;
};

class BadOverrides : public DeploymentTest, public ::testing::WithParamInterface<BadOverride> {};

TEST_P(BadOverrides, AreRefusedWithWhatWasExpected) {
  EXPECT_THAT(ErrorOf(kTwo, GetParam().overrides),
              AllOf(HasSubstr("expected"), HasSubstr(GetParam().word), Not(HasSubstr("\n"))));
}

INSTANTIATE_TEST_SUITE_P(
    Options, BadOverrides,
    ::testing::Values(BadOverride{{{"seed"}, {}, {}, {}}, "KEY=VALUE"},
                      BadOverride{{{"seed=x"}, {}, {}, {}}, "whole number"},
                      BadOverride{{{"seed=-1"}, {}, {}, {}}, "whole number"},
                      BadOverride{{{"domain_id=300"}, {}, {}, {}}, "232"},
                      BadOverride{{{"interfaces=nowhere0"}, {}, {}, {}}, "interfaces: lo"},
                      BadOverride{{{"duration_s=nan"}, {}, {}, {}}, "number"},
                      BadOverride{{{"speed=1"}, {}, {}, {}}, "mode"},
                      BadOverride{{{"robot.config=x"}, {}, {}, {}}, "plant, logger"},
                      BadOverride{{{"plant.config=/nowhere"}, {}, {}, {}}, "existing file"},
                      BadOverride{{{"plant.program=nothing"}, {}, {}, {}}, "nothing"},
                      BadOverride{{{"plant.colour=red"}, {}, {}, {}}, "PROCESS.config"},
                      BadOverride{{{}, {"plant"}, {}, {}}, "PROCESS=ARGUMENT"},
                      BadOverride{{{}, {"robot=x"}, {}, {}}, "plant, logger"},
                      BadOverride{{{}, {}, {"plant"}, {}}, "provider"},
                      BadOverride{{{}, {}, {"robot"}, {}}, "plant, logger"}));

}  // namespace
}  // namespace sinew::launch
