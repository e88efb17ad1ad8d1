#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stdexcept>

#include "reproduction/squat_test/section.h"
#include "tests/reproduction/squat_test/squats.h"

namespace sinew::squat_test {
namespace {

using ::testing::HasSubstr;

std::function<double(double)> Always(double error_rad) {
  return [error_rad](double) { return error_rad; };
}

std::vector<Squats> Benchmark() {
  return {SquatsOf("pid", Load::kNone, Always(0.1)), SquatsOf("pid-esn", Load::kNone, Always(0.03)),
          SquatsOf("computed-torque", Load::kNone, Always(0.02)),
          SquatsOf("computed-torque", Load::kFromStart, Always(0.2)),
          SquatsOf("adapted", Load::kFromStart, Always(0.1))};
}

TEST(SquatSection, ComparesRatiosOfErrorsWithTheGoals) {
  const report::Section section = MakeSection(Benchmark(), {});
  report::CheckSection(section);
  ASSERT_EQ(section.comparisons.size(), 2U);
  EXPECT_EQ(section.comparisons[0].ours, "0.090");
  EXPECT_TRUE(section.comparisons[0].met.value());
  EXPECT_EQ(section.comparisons[1].ours, "0.250");
  EXPECT_FALSE(section.comparisons[1].met.value());
}

TEST(SquatSection, AFallIsNoError) {
  std::vector<Squats> benchmark = Benchmark();
  benchmark[1].fall_s = 4.2;
  const report::Section section = MakeSection(benchmark, {});
  EXPECT_EQ(section.comparisons[0].ours, "fell");
  EXPECT_FALSE(section.comparisons[0].met.value());
  bool shown = false;
  for (const auto& row : section.tables[0].rows) {
    for (const std::string& cell : row) shown = shown || cell == "fell at 4.2 s";
  }
  EXPECT_TRUE(shown);
}

TEST(SquatSection, AMissingArmIsNamed) {
  std::vector<Squats> benchmark = Benchmark();
  benchmark.pop_back();
  try {
    MakeSection(benchmark, {});
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_THAT(error.what(), HasSubstr("'adapted'"));
  }
}

// The load comes at 18.5 s; the error is 0.02 before, 0.1 for four seconds, then 0.021.
TEST(SquatSection, RecoveryIsBesideTheLastSquatWithoutTheLoad) {
  const Squats squats = SquatsOf("adapted", Load::kPutOn, [](double t) {
    return t < 18.5 ? 0.02 : t < 22.5 ? 0.1 : 0.021;
  });
  const Recovery recovery = RecoveryOf(squats);
  EXPECT_NEAR(recovery.before_rad, 0.02, 1e-12);
  ASSERT_EQ(recovery.after_rad.size(), 3U);
  EXPECT_NEAR(recovery.after_rad[0], std::sqrt(0.8 * 0.01 + 0.2 * 0.021 * 0.021), 1e-9);
  EXPECT_NEAR(recovery.after_rad[2], 0.021, 1e-9);
  // The window of 1.5 s has left the error behind after 22.5 + 1.5 s, but for a few ticks.
  EXPECT_NEAR(recovery.settled_s.value(), 5.5, 0.05);
  std::vector<Squats> benchmark = Benchmark();
  const report::Section section = MakeSection(benchmark, {squats});
  ASSERT_EQ(section.comparisons.size(), 3U);
  EXPECT_EQ(section.comparisons[2].ours, "+5 %, +5 %");
  EXPECT_TRUE(section.comparisons[2].met.value());
}

}  // namespace
}  // namespace sinew::squat_test
