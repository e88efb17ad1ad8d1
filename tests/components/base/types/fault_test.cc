#include "components/base/types/fault.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <regex>
#include <set>
#include <string>

namespace sinew::types {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

TEST(Fault, IsTheSameAfterItsMessage) {
  const Fault robot{.cause = FaultCause::kCycleLate, .value = 80.0, .limit = 60.0};
  const Fault joint{.cause = FaultCause::kAnotherMaster, .joint = 3, .value = 1.5, .limit = 1.0};
  for (const Fault& fault : {Fault{}, robot, joint}) {
    EXPECT_EQ(FromMessage(ToMessage(fault)), fault);
  }
}

TEST(FaultText, SaysCauseValueLimitAndWhatToDo) {
  EXPECT_THAT(
      FaultText({.cause = FaultCause::kCommandMissing, .value = 62.4, .limit = 60.0}),
      StartsWith("joint_command missing for 62.4 ms, limit 60 ms: is the controller alive"));
  EXPECT_THAT(FaultText({.cause = FaultCause::kCommandJoints, .value = 12.0, .limit = 1.0}),
              StartsWith("joint_command names 12 joints, expected 1 joints: the controller is"));
  EXPECT_THAT(FaultText({.cause = FaultCause::kCommandNotFinite, .joint = 2}),
              StartsWith("joint 2: joint_command is not a finite number: "));
  EXPECT_THAT(FaultText({.cause = FaultCause::kHeartbeatLost, .value = 512.0, .limit = 500.0},
                        "bus 'can0' is down"),
              StartsWith("no heartbeat for 512 ms, limit 500 ms, bus 'can0' is down: is its"));
  EXPECT_THAT(FaultText({.cause = FaultCause::kAxisError, .value = 64.0, .limit = 64.0}, "0x40"),
              StartsWith("axis error: 0x40: "));
  EXPECT_EQ(FaultText({}), "");
}

TEST(FaultText, EveryCauseHasTermsOfItsOwnWhichFitAStatus) {
  constexpr std::size_t kLongestMessage = 255;  // idl/status.idl
  std::set<std::string> names;
  for (int i = 0; i < kFaultCauses; ++i) {
    const auto cause = static_cast<FaultCause>(i);
    const FaultTerms& terms = TermsOf(cause);
    EXPECT_EQ(terms.cause, cause) << i;
    EXPECT_TRUE(names.emplace(terms.name).second) << terms.name;
    if (cause == FaultCause::kNone) continue;
    EXPECT_NE(terms.remedy, "") << terms.name;
    EXPECT_LT(FaultText({cause, 11, 123456.7, 12345.6}).size(), kLongestMessage) << terms.name;
  }
}

TEST(FaultText, TheDocumentedCausesAreThese) {
  std::set<std::string> documented, names;
  const std::regex row(R"(\| `FAULT_\w+` \| ([^|]*) \|.*)");
  std::ifstream page(SINEW_SOURCE_DIR "/docs/formats.md");
  for (std::string line; std::getline(page, line);) {
    std::smatch cells;
    if (std::regex_match(line, cells, row)) documented.insert(cells[1]);
  }
  for (int i = 1; i < kFaultCauses; ++i) {
    names.emplace(TermsOf(static_cast<FaultCause>(i)).name);
  }
  EXPECT_EQ(documented, names);
}

}  // namespace
}  // namespace sinew::types
