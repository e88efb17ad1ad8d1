#include "components/trace/rules.h"

#include <gtest/gtest.h>

#include <fstream>
#include <set>
#include <sstream>

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

TEST(TraceRules, ThereAreAtMostTwentyEachWithANameAndASource) {
  EXPECT_LE(AllRules().size(), 20u);
  std::set<std::string> names;
  for (const Rule& rule : AllRules()) {
    EXPECT_TRUE(names.insert(rule.id).second) << rule.id;
    EXPECT_FALSE(std::string(rule.statistic).empty()) << rule.id;
    EXPECT_FALSE(std::string(rule.source).empty()) << rule.id;
  }
}

}  // namespace
}  // namespace sinew::trace
