#include "components/model/trace/rules.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <set>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

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

TEST(TraceRules, ThereAreAtMostTwentyThreeEachWithANameAndASource) {
  EXPECT_LE(AllRules().size(), 23u);
  std::set<std::string> names;
  for (const Rule& rule : AllRules()) {
    EXPECT_TRUE(names.insert(rule.id).second) << rule.id;
    EXPECT_FALSE(std::string(rule.statistic).empty()) << rule.id;
    EXPECT_FALSE(std::string(rule.source).empty()) << rule.id;
  }
}

TEST(TraceRules, OneThatIsTakenOutDecidesNothing) {
  EXPECT_EQ(Limit(rules::kScore), rules::kScore.limit);
  EXPECT_EXIT(
      {
        TakeOut("score");
        const bool alone = TakenOut() == std::vector<std::string>{"score"};
        const bool others = Limit(rules::kRaises) == rules::kRaises.limit;
        std::exit(alone && others && Limit(rules::kScore) == rules::kScore.off ? 0 : 1);
      },
      ::testing::ExitedWithCode(0), "");
  EXPECT_THROW(TakeOut("scores"), std::invalid_argument);
}

TEST(TraceRules, EachHasAnotherLimitWhenItIsTakenOut) {
  for (const Rule& rule : AllRules()) EXPECT_NE(rule.limit, rule.off) << rule.id;
}

}  // namespace
}  // namespace sinew::trace
