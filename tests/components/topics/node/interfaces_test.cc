#include "components/topics/node/interfaces.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "components/base/config/config.h"

namespace sinew::node::internal {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

const std::vector<InterfaceAddress> kMachine = {
    {"lo", "127.0.0.1"}, {"eth0", "10.0.0.7"}, {"wlan0", "192.168.1.5"}, {"eth0", "10.1.0.7"}};

std::vector<std::string> Allowed(const std::vector<std::string>& names) {
  std::vector<std::string> addresses;
  for (const auto& entry : AllowedAddresses(names, kMachine)) addresses.push_back(entry.address);
  return addresses;
}

std::string RefusalOf(const std::vector<std::string>& names,
                      const std::vector<InterfaceAddress>& machine) {
  try {
    AllowedAddresses(names, machine);
  } catch (const UsageError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(Interfaces, NoneNamedIsLoopbackAlone) { EXPECT_THAT(Allowed({}), ElementsAre("127.0.0.1")); }

TEST(Interfaces, LoopbackIsThereOnceWhateverIsNamed) {
  EXPECT_THAT(Allowed({"lo"}), ElementsAre("127.0.0.1"));
  EXPECT_THAT(Allowed({"wlan0", "lo", "wlan0"}), ElementsAre("127.0.0.1", "192.168.1.5"));
}

TEST(Interfaces, AllAddressesOfANamedOneCountAndNoOther) {
  EXPECT_THAT(Allowed({"eth0"}), ElementsAre("127.0.0.1", "10.0.0.7", "10.1.0.7"));
}

TEST(Interfaces, AnUnknownOneIsRefusedWithTheOptionAndWhatThereIs) {
  EXPECT_THAT(RefusalOf({"eth0", "eth7"}, kMachine),
              AllOf(HasSubstr("--interface eth7"), HasSubstr("wlan0 (192.168.1.5)")));
  EXPECT_THAT(RefusalOf({""}, kMachine), HasSubstr("--interface"));
}

TEST(Interfaces, AMachineWithoutLoopbackIsRefused) {
  EXPECT_THAT(RefusalOf({}, {{"eth0", "10.0.0.7"}}), HasSubstr("expected 127.0.0.1 on lo"));
}

TEST(Interfaces, TheseOfThisMachineHoldLoopback) {
  EXPECT_THAT(AllowedAddresses({}, RunningInterfaces()), ::testing::SizeIs(1));
  EXPECT_TRUE(IsLoopback("127.0.0.1"));
  EXPECT_FALSE(IsLoopback("10.127.0.1"));
}

TEST(Interfaces, AnAddressIsOfTheNetworkOfItsMask) {
  const InterfaceAddress home = {"eth0", "10.1.2.3", 0xffffff00};
  EXPECT_TRUE(IsOfNetwork(home, NumberOf("10.1.2.250")));
  EXPECT_FALSE(IsOfNetwork(home, NumberOf("10.1.3.3")));
  EXPECT_FALSE(IsOfNetwork(home, NumberOf("127.0.0.1")));
  EXPECT_FALSE(IsOfNetwork(home, NumberOf("no address")));
  const InterfaceAddress alone = {"eth0", "10.1.2.3"};
  EXPECT_TRUE(IsOfNetwork(alone, NumberOf("10.1.2.3")));
  EXPECT_FALSE(IsOfNetwork(alone, NumberOf("10.1.2.4")));
}

}  // namespace
}  // namespace sinew::node::internal
