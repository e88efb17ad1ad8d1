// Sections of a page: what is written is read again, pictures keep their names apart, bad ones are
// refused.
#include "components/model/report/section.h"

#include <cmath>
#include <filesystem>

#include "components/base/config/config.h"
#include "components/model/report/file/section_file.h"
#include "tests/support/skip.h"
#include "tests/support/temporary_folder.h"

namespace sinew::report {
namespace {

Section Example() {
  Section section;
  section.id = "backlash";
  section.title = "Backlash <of the gear>";
  section.paragraphs = {"100 trials."};
  section.comparisons.push_back({"backlash", "degrees", "2.66", "Fig 5.1", "2.662",
                                 "2.655 .. 2.669", "2.66", "within 0.05", true, "mean of 100"});
  section.comparisons.push_back({"friction", "Nm", "0.22", "", "0.3", "", "", "5 %", false, ""});
  section.comparisons.push_back({"no target", "", "", "", "1", "", "", "", std::nullopt, ""});
  section.tables.push_back({"Trials", "caption", {"a", "b"}, {{"1", "2"}, {"3", ""}}});
  section.pictures.push_back({"Angle", "over time", PictureHead(200) + "plot sin(x)\n"});
  section.pictures.push_back({"Other", "", PictureHead(200) + "plot cos(x)\n"});
  section.seconds = 1.5;
  return section;
}

TEST(Section, IsReadAsItWasWritten) {
  const testing::TemporaryFolder folder;
  WriteSection(folder.path() / "deep" / "er", Example());
  const Section read = ReadSection(folder.path() / "deep" / "er");
  const Section example = Example();
  EXPECT_EQ(read.id, example.id);
  EXPECT_EQ(read.title, example.title);
  EXPECT_EQ(read.paragraphs, example.paragraphs);
  ASSERT_EQ(read.comparisons.size(), 3u);
  EXPECT_EQ(read.comparisons[0].interval, "2.655 .. 2.669");
  EXPECT_EQ(read.comparisons[0].met, true);
  EXPECT_EQ(read.comparisons[1].met, false);
  EXPECT_FALSE(read.comparisons[2].met.has_value());
  ASSERT_EQ(read.tables.size(), 1u);
  EXPECT_EQ(read.tables[0].rows, example.tables[0].rows);
  ASSERT_EQ(read.svgs.size(), 2u);
  EXPECT_EQ(read.seconds, 1.5);
  EXPECT_TRUE(std::filesystem::exists(folder.path() / "deep" / "er" / "backlash-2.svg"));
}

TEST(Section, PicturesOfOnePageShareNoNames) {
  const auto svgs = DrawPictures(Example().pictures);
  ASSERT_EQ(svgs.size(), 2u);
  const std::size_t at = svgs[0].find("id='p");
  SKIP_WITHOUT_PACKAGE(at != std::string::npos, "gnuplot-nox");
  const std::string name = svgs[0].substr(at, svgs[0].find('_', at) - at);
  EXPECT_EQ(svgs[1].find(name), std::string::npos);
}

TEST(Section, BadOnesAreRefusedAndLeaveNothing) {
  const testing::TemporaryFolder folder;
  Section section = Example();
  section.tables[0].rows.push_back({"only one"});
  EXPECT_THROW(WriteSection(folder.path() / "x", section), std::invalid_argument);
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "x"));
  section = Example();
  section.id = "Two Words";
  EXPECT_THROW(CheckSection(section), std::invalid_argument);
  section = Example();
  section.title.clear();
  EXPECT_THROW(CheckSection(section), std::invalid_argument);
}

TEST(Section, ABrokenFileIsNamed) {
  const testing::TemporaryFolder folder;
  config::WriteFileAtomically(folder.path() / "section.json", "{\"schema\": \"sinew-section/1\"}");
  try {
    ReadSection(folder.path());
    FAIL() << "a section without an id was read";
  } catch (const UsageError& problem) {
    EXPECT_NE(std::string(problem.what()).find("section.json"), std::string::npos);
    EXPECT_NE(std::string(problem.what()).find("id"), std::string::npos);
  }
}

TEST(Chart, HasItsDataAndNoQuoteThatEndsAString) {
  const Picture picture =
      Chart("title", "", "it's x", 200,
            {{"y", {{.name = "it's a", .x = {0.0, 1.0, 2.0}, .y = {1.0, std::nan(""), 2.0}}}}});
  EXPECT_NE(picture.script.find("plot $d0"), std::string::npos);
  EXPECT_NE(picture.script.find("0 1\n\n2 2\n"), std::string::npos);
  EXPECT_EQ(picture.script.find("it's"), std::string::npos);
  EXPECT_NE(Chart("", "", "x", 200, {{"y", {}}}).script.find("plot 0"), std::string::npos);
}

}  // namespace
}  // namespace sinew::report
