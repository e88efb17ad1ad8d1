#include "reproduction/paper/page.h"

#include <gtest/gtest.h>

#include <optional>
#include <string>

namespace sinew::reproduction {
namespace {

TEST(Page, CountsTargetsAndEscapesText) {
  report::Section section;
  section.id = "backlash";
  section.title = "Backlash <of the gear>";
  section.comparisons.push_back({"backlash", "degrees", "2.66", "Fig 5.1", "2.662",
                                 "2.655 .. 2.669", "2.66", "within 0.05", true, "mean of 100"});
  section.comparisons.push_back({"friction", "Nm", "0.22", "", "0.3", "", "", "5 %", false, ""});
  section.comparisons.push_back({"no target", "", "", "", "1", "", "", "", std::nullopt, ""});
  section.tables.push_back({"Trials", "caption", {"a", "b"}, {{"1", "2"}, {"3", ""}}});
  const std::string page = FormatPage({"All & everything", "intro"}, {section});
  EXPECT_NE(page.find("Targets: 1 of 2 reached"), std::string::npos);
  EXPECT_NE(page.find("All &amp; everything"), std::string::npos);
  EXPECT_NE(page.find("Backlash &lt;of the gear&gt;"), std::string::npos);
  EXPECT_EQ(page.find("<of the gear>"), std::string::npos);
}

}  // namespace
}  // namespace sinew::reproduction
