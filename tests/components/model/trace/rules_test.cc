#include "components/model/trace/rules.h"

#include <gtest/gtest.h>

#include <fstream>
#include <set>
#include <sstream>
#include <string>

namespace sinew::trace {
namespace {

TEST(TraceRules, TheDocumentationHoldsTheTable) {
  std::ifstream file(SINEW_SOURCE_DIR "/docs/closing-the-loop.md");
  ASSERT_TRUE(file) << "docs/closing-the-loop.md cannot be read";
  std::stringstream text;
  text << file.rdbuf();
  EXPECT_NE(text.str().find(FormatRules()), std::string::npos)
      << "docs/closing-the-loop.md lacks this table:\n"
      << FormatRules();
}

TEST(TraceRules, ThereAreAtMostTwentyTwoEachWithANameAndASource) {
  EXPECT_LE(AllRules().size(), 22u);
  std::set<std::string> names;
  for (const Rule& rule : AllRules()) {
    EXPECT_TRUE(names.insert(rule.id).second) << rule.id;
    EXPECT_FALSE(std::string(rule.statistic).empty()) << rule.id;
    EXPECT_FALSE(std::string(rule.source).empty()) << rule.id;
  }
}

TEST(TraceRules, OneThatIsTakenOutDecidesNothing) {
  EXPECT_EQ(InForce{}.Limit(rules::kScore), rules::kScore.limit);
  const InForce without{.without_rules = {"score"}};
  EXPECT_EQ(without.Limit(rules::kScore), rules::kScore.off);
  EXPECT_EQ(without.Limit(rules::kRaises), rules::kRaises.limit);
  EXPECT_EQ(without.RefusedBy(rules::kScore, 0.1).limit, rules::kScore.off);
}

TEST(TraceRules, EachHasAnotherLimitWhenItIsTakenOut) {
  for (const Rule& rule : AllRules()) EXPECT_NE(rule.limit, rule.off) << rule.id;
}

}  // namespace
}  // namespace sinew::trace
