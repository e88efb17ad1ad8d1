#include "components/model/gate/rules.h"

#include <gtest/gtest.h>

#include <fstream>
#include <set>
#include <sstream>

#include "components/model/gate/gate.h"

namespace sinew::gate {
namespace {

TEST(GateRules, TheDocumentationHoldsTheTable) {
  std::ifstream file(SINEW_SOURCE_DIR "/docs/data-gate.md");
  ASSERT_TRUE(file) << "docs/data-gate.md cannot be read";
  std::stringstream text;
  text << file.rdbuf();
  EXPECT_NE(text.str().find(FormatRules()), std::string::npos)
      << "docs/data-gate.md lacks this table:\n"
      << FormatRules();
}

TEST(GateRules, EveryRuleHasItsOwnNameAndSaysWhereItsLimitComesFrom) {
  std::set<std::string_view> names;
  for (const Rule& rule : Rules()) {
    EXPECT_TRUE(names.insert(rule.id).second) << rule.id;
    EXPECT_FALSE(rule.statistic.empty()) << rule.id;
    EXPECT_FALSE(rule.limit_source.empty()) << rule.id;
    EXPECT_GE(rule.limit, 0.0) << rule.id;
  }
}

TEST(GateRules, TheTableHoldsHowManySpikesAreLeftOut) {
  EXPECT_EQ(kMostLeftOut, 5u);
  EXPECT_NE(FindRule("spike").statistic.find("more than five rows"), std::string_view::npos);
}

TEST(GateRules, AnUnknownRuleIsRefusedWithTheKnownOnes) {
  try {
    FindRule("spikes");
    FAIL() << "no throw";
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find("spike"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace sinew::gate
