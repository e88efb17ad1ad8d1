// The roles, as the table of topics has them.
#include "tools/conform/role.h"

#include <gtest/gtest.h>

#include "components/base/config/config.h"
#include "tools/conform/robot.h"

namespace sinew::conform {
namespace {

TEST(ConformRoles, AreThoseOfTheTableOfTopics) {
  for (const std::string& name : RoleNames()) {
    const Role role = FindRole(name);
    EXPECT_FALSE(role.must_write.empty()) << name;
    for (const node::TopicInfo& topic : role.must_write) EXPECT_TRUE(role.Writes(topic.name));
  }
  const Role pneumatics = FindRole("pneumatics");
  EXPECT_TRUE(pneumatics.Writes("valve_command"));
  EXPECT_TRUE(pneumatics.Writes("pneumatic_state"));
  EXPECT_TRUE(pneumatics.Writes("sim_pressure")) << "the ideal source does";
  EXPECT_EQ(pneumatics.must_write.size(), 2u);
  EXPECT_FALSE(pneumatics.Writes("joint_command"));
  EXPECT_TRUE(FindRole("control").commands_joints);
  EXPECT_FALSE(FindRole("regime").commands_joints);
}

TEST(ConformRoles, AnotherNameIsRefusedWithTheList) {
  try {
    (void)FindRole("surrogate");
    FAIL() << "a state provider makes its own ticks";
  } catch (const UsageError& error) {
    EXPECT_NE(std::string(error.what()).find("pneumatics, regime, reference"), std::string::npos)
        << error.what();
  }
}

TEST(ConformRoles, RulesNameInputsThatArePlayedAndOutputsOfTheRole) {
  const std::vector<std::string_view> played = PlayedTopics();
  for (const StaleRule& rule : StaleRules()) {
    EXPECT_NE(std::find(played.begin(), played.end(), rule.input), played.end()) << rule.input;
    EXPECT_TRUE(FindRole(std::string(rule.role)).Writes(rule.output)) << rule.output;
  }
}

}  // namespace
}  // namespace sinew::conform
