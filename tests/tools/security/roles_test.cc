// Roles are the writers of the table in idl/README.md: nobody is forgotten, nobody gets more.
#include "tools/roles/roles.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "components/base/config/config.h"
#include "components/topics/node/topics.h"
#include "tools/launch/deployment.h"
#include "tools/security/documents.h"
#include "tools/security/members.h"

namespace sinew::security {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

TEST(Roles, EveryWriterOfTheTableHasOne) { EXPECT_THAT(PartiesWithoutRole(), IsEmpty()); }

TEST(Roles, AnObserverWritesItsStatusAndItsLogAlone) {
  EXPECT_THAT(TopicsWrittenBy({"observer"}), ElementsAre("component_status", "log"));
}

TEST(Roles, OnlyOperatorsAndEstopsWriteOperatorCommands) {
  for (const std::string& role : RoleNames()) {
    const bool may = role == "operator" || role == "estop";
    const auto topics = TopicsWrittenBy({role});
    EXPECT_EQ(std::count(topics.begin(), topics.end(), "operator_command"), may ? 1 : 0) << role;
    EXPECT_THAT(topics, Contains("component_status")) << role;
    EXPECT_THAT(topics, Contains("log")) << role;
    EXPECT_FALSE(PurposeOf(role).empty()) << role;
  }
}

TEST(Roles, ParticipantsOfTheChainWriteWhatTheTableSays) {
  EXPECT_THAT(TopicsWrittenBy({"control"}),
              ElementsAre("component_snapshot", "component_status", "joint_command", "log"));
  EXPECT_THAT(TopicsWrittenBy({"esn"}), ElementsAre("component_snapshot", "component_status", "log",
                                                    "reservoir_state", "torque_prediction"));
  EXPECT_THAT(TopicsWrittenBy({"provider"}), Contains("joint_state"));
  EXPECT_THAT(TopicsWrittenBy({"provider"}), Not(Contains("joint_command")));
}

TEST(Roles, APlayerWritesNoCommandingTopicUnlessItHasThatRoleToo) {
  const auto player = TopicsWrittenBy({"player"});
  EXPECT_THAT(player, Contains("joint_state"));
  for (const std::string& topic : CommandingTopics()) EXPECT_THAT(player, Not(Contains(topic)));
  EXPECT_THAT(TopicsWrittenBy({"player", "reference"}), Contains("reference"));
}

TEST(Roles, AnUnknownOneIsRefusedWithTheNames) {
  try {
    (void)TopicsWrittenBy({"king"});
    FAIL();
  } catch (const UsageError& error) {
    EXPECT_THAT(error.what(), HasSubstr("no role 'king', expected one of: provider, control"));
  }
}

TEST(Documents, AGrantNamesExactlyTheTopicsOfItsRoles) {
  const std::string text = Permissions({.name = "eye",
                                        .subject = "CN=eye,O=a & b",
                                        .roles = {"observer"},
                                        .domain_id = 7,
                                        .not_before = "2026-01-01T00:00:00",
                                        .not_after = "2027-01-01T00:00:00"});
  EXPECT_THAT(
      text,
      HasSubstr(
          "<publish><topics>\n<topic>component_status</topic>\n<topic>log</topic>\n</topics>"));
  EXPECT_THAT(text, HasSubstr("<subject_name>CN=eye,O=a &amp; b</subject_name>"));
  EXPECT_THAT(text, HasSubstr("<id>7</id>"));
}

TEST(Documents, CommandingTopicsComeBeforeTheRest) {
  const std::string text = Governance(7);
  const std::size_t rest = text.find("<topic_expression>*<");
  ASSERT_NE(rest, std::string::npos);
  for (const std::string& topic : CommandingTopics()) {
    const std::size_t at = text.find("<topic_expression>" + topic + "<");
    EXPECT_LT(at, rest) << topic;
    EXPECT_EQ(text.find("<data_protection_kind>", at),
              text.find("<data_protection_kind>ENCRYPT", at))
        << topic;
  }
}

launch::Deployment DeploymentOf(const std::vector<std::pair<std::string, std::string>>& programs) {
  launch::Deployment deployment;
  deployment.file = "rig.yaml";
  for (const auto& [name, program] : programs) {
    launch::Process process;
    process.name = name;
    process.program = program;
    deployment.processes.push_back(process);
  }
  return deployment;
}

TEST(Members, AProcessHasTheRoleOfItsProgramAndTheProviderItsOwn) {
  launch::Deployment deployment = DeploymentOf({{"robot", "/bin/my-robot"},
                                                {"esn", "/bin/sinew-inverse-dynamics"},
                                                {"mine", "/bin/controller"},
                                                {"foreign", "/bin/cat"}});
  deployment.provider = "robot";
  deployment.processes[3].plain = true;
  const auto members = MembersOf(deployment, {{"mine", {"control"}}}, "here");
  std::vector<std::string> texts;
  for (const Member& member : members) texts.push_back(member.name + ":" + member.roles.front());
  EXPECT_THAT(texts, ElementsAre("robot:provider", "esn:esn", "mine:control", "operator:operator",
                                 "observer:observer", "logger:logger", "player:player"));
}

TEST(Members, WhatIsNotKnownIsAskedFor) {
  const auto error_of = [](const launch::Deployment& deployment,
                           const std::map<std::string, std::vector<std::string>>& roles) {
    try {
      (void)MembersOf(deployment, roles, "here");
      return std::string();
    } catch (const UsageError& error) {
      return std::string(error.what());
    }
  };
  EXPECT_THAT(error_of(DeploymentOf({{"mine", "/bin/controller"}}), {}),
              HasSubstr("process 'mine': the role of controller is not known, expected --role "
                        "mine=ROLE"));
  EXPECT_THAT(error_of(DeploymentOf({}), {{"mine", {"control"}}}),
              HasSubstr("--role mine=control: expected a process of rig.yaml"));
  EXPECT_THAT(error_of(DeploymentOf({{"operator", "/bin/sinew-control"}}), {}),
              HasSubstr("process 'operator' has the role control"));
}

}  // namespace
}  // namespace sinew::security
