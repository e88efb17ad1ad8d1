#include "tools/sinew/progress.h"

#include <gtest/gtest.h>

namespace sinew::tools {
namespace {

TEST(ProgressBar, ShowsShareRateAndTimeLeft) {
  EXPECT_EQ(ProgressBar::Line("import", "samples", 12900, 25800, 0.5),
            "import  [##########----------]  50 %  12.9k of 25.8k samples, 25.8k/s, 0:01 left");
  EXPECT_EQ(ProgressBar::Line("import", "samples", 0, 100, 0.0),
            "import  [--------------------]   0 %  0 of 100 samples, 0/s, 0:00 left");
  EXPECT_EQ(ProgressBar::Line("fit", "runs", 3, 3, 600.0),
            "fit  [####################] 100 %  3 of 3 runs, 0/s, 0:00 left");
}

TEST(ProgressBar, ShowsCountAndRateWhenTheTotalIsUnknown) {
  EXPECT_EQ(ProgressBar::Line("record", "messages", 2500000, 0, 100.0),
            "record  2.5M messages, 25.0k/s");
}

TEST(ProgressBar, StaysAtTheEndWhenThereIsMoreThanExpected) {
  EXPECT_EQ(ProgressBar::Line("x", "y", 300, 200, 1.0),
            "x  [####################] 100 %  300 of 200 y, 300/s, 0:00 left");
}

}  // namespace
}  // namespace sinew::tools
