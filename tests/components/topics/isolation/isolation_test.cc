#include "components/topics/isolation/isolation.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <string>

#include "components/base/config/config.h"

namespace sinew::isolation {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::string Refusal(const std::string& deployment, int domain_id) {
  try {
    (void)Chosen(deployment, domain_id);
  } catch (const UsageError& error) {
    return error.what();
  }
  return "";
}

TEST(Isolation, WithoutADeploymentTheHostsNetworkIsUsed) {
  EXPECT_FALSE(Chosen("none", 0).has_value());
  EXPECT_FALSE(Chosen("", 232).has_value());
  EXPECT_THAT(Refusal("nowhere", 0),
              AllOf(HasSubstr("--deployment nowhere"), HasSubstr("expected one of this user's")));
}

TEST(Isolation, TheCommandLineOfAHolderNamesDeploymentDomainAndInterfaces) {
  EXPECT_THAT(HolderArguments("rig", 7, {"can0", "can1"}),
              ElementsAre("isolate", "rig", "--domain", "7", "--move", "can0", "--move", "can1"));
}

// Before anything of the process is changed.
TEST(Isolation, AnInterfaceThatDoesNotExistIsRefused) {
  try {
    const Isolation isolation("test", {"nowhere0"});
    FAIL();
  } catch (const UsageError& error) {
    EXPECT_THAT(error.what(), HasSubstr("interface nowhere0"));
  }
  EXPECT_FALSE(Chosen("", 232).has_value());
}

}  // namespace
}  // namespace sinew::isolation
