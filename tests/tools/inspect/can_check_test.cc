// CAN interfaces as `ip -json -details -statistics link show` of iproute2 6.1 prints them.
#include "tools/inspect/can_check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stdexcept>

namespace sinew::inspect {
namespace {

using ::testing::HasSubstr;

std::string Link(const std::string& state, int bitrate, int restart_ms, int queue,
                 const std::string& counters = "", const std::string& flags = "\"UP\",") {
  return R"([{"ifname":"lo","link_type":"loopback","flags":["UP"]},
    {"ifindex":4,"ifname":"can0","flags":[)" +
         flags + R"("NOARP","ECHO"],"mtu":16,"operstate":"UP","txqlen":)" + std::to_string(queue) +
         R"(,"link_type":"can","linkinfo":{"info_kind":"can","info_data":{"state":")" + state +
         R"(","restart_ms":)" + std::to_string(restart_ms) + R"(,"bittiming":{"bitrate":)" +
         std::to_string(bitrate) +
         R"(,"sample_point":"0.750"},"clock":8000000},"info_xstats":{"restarts":0)" + counters +
         "}}}]";
}

Finding CheckOne(const std::string& json) {
  const std::vector<Finding> findings = CheckCan(json, {});
  EXPECT_EQ(findings.size(), 1u);
  return findings.at(0);
}

TEST(CanCheck, AnInterfaceAsBringUpAsksForIsFine) {
  const Finding finding = CheckOne(Link("ERROR-ACTIVE", 1'000'000, 100, 128));
  EXPECT_EQ(finding.severity, Severity::kOk) << finding.text;
  EXPECT_EQ(finding.text, "can0: up, ERROR-ACTIVE, 1000000 bit/s");
}

TEST(CanCheck, BusOffAndErrorPassiveAreFaults) {
  const Finding off = CheckOne(Link("BUS-OFF", 1'000'000, 100, 128));
  EXPECT_EQ(off.severity, Severity::kFault);
  EXPECT_THAT(off.text, HasSubstr("BUS-OFF"));
  const Finding passive = CheckOne(Link("ERROR-PASSIVE", 1'000'000, 100, 128));
  EXPECT_EQ(passive.severity, Severity::kFault);
  EXPECT_THAT(passive.advice, HasSubstr("termination"));
  EXPECT_EQ(CheckOne(Link("ERROR-WARNING", 1'000'000, 100, 128)).severity, Severity::kWarning);
}

TEST(CanCheck, OtherSettingsThanBringUpAsksForAreNamed) {
  const Finding rate = CheckOne(Link("ERROR-ACTIVE", 250'000, 100, 128));
  EXPECT_EQ(rate.severity, Severity::kFault);
  EXPECT_THAT(rate.text, HasSubstr("250000 bit/s, expected 1000000"));
  EXPECT_THAT(rate.advice, HasSubstr("bitrate 1000000 restart-ms 100"));
  EXPECT_THAT(CheckOne(Link("ERROR-ACTIVE", 1'000'000, 0, 128)).text, HasSubstr("restart-ms 0"));
  EXPECT_THAT(CheckOne(Link("ERROR-ACTIVE", 1'000'000, 100, 10)).text, HasSubstr("txqueuelen 10"));
}

TEST(CanCheck, ErrorsInThePastAreAWarning) {
  const Finding finding =
      CheckOne(Link("ERROR-ACTIVE", 1'000'000, 100, 128, R"(,"bus_off":2,"bus_error":17)"));
  EXPECT_EQ(finding.severity, Severity::kWarning);
  EXPECT_THAT(finding.text, HasSubstr("bus_off 2"));
  EXPECT_THAT(finding.text, HasSubstr("bus_error 17"));
}

TEST(CanCheck, AnInterfaceThatIsDownIsAFault) {
  const Finding finding = CheckOne(Link("STOPPED", 0, 0, 10, "", ""));
  EXPECT_EQ(finding.severity, Severity::kFault);
  EXPECT_THAT(finding.text, HasSubstr("can0: down, not started"));
}

TEST(CanCheck, AVirtualOneNeedsNoBitrate) {
  const Finding finding = CheckOne(
      R"([{"ifname":"vcan0","flags":["UP"],"link_type":"can","linkinfo":{"info_kind":"vcan"}}])");
  EXPECT_EQ(finding.severity, Severity::kOk);
  EXPECT_EQ(finding.text, "vcan0: up, virtual");
}

TEST(CanCheck, NoneIsANoteAndNoListIsAnError) {
  EXPECT_EQ(CheckOne("[{},{}]").severity, Severity::kNote);
  EXPECT_EQ(CheckOne("[]").severity, Severity::kNote);
  EXPECT_THROW((void)CheckCan("Object \"link\" is unknown", {}), std::invalid_argument);
  EXPECT_THROW((void)CheckCan("", {}), std::invalid_argument);
}

TEST(CanCheck, NamesWireGuardTunnelsAndNoOtherInterface) {
  const std::string text = R"([{"ifname":"lo"},
    {"ifname":"wg0","flags":["POINTOPOINT","NOARP","UP","LOWER_UP"],"link_type":"none",
     "linkinfo":{"info_kind":"wireguard"}},
    {"ifname":"wg1","linkinfo":{"info_kind":"dummy"}}])";
  EXPECT_EQ(WireGuardIn(text), std::vector<std::string>{"wg0"});
  EXPECT_EQ(WireGuardIn("").size() + WireGuardIn("{}").size() + WireGuardIn("[1]").size(), 0U);
}

}  // namespace
}  // namespace sinew::inspect
