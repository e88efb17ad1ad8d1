#include <gtest/gtest.h>

#include "components/model/experiment/result.h"
#include "components/model/experiment/rows.h"

namespace sinew::experiment {
namespace {

Result Example() {
  Result result{.experiment = "backlash", .title = "Play"};
  result.quantities = {{.id = "backlash_deg",
                        .name = "backlash",
                        .unit = "degrees",
                        .estimate = {2.661, 0.002, 100},
                        .published = 2.66,
                        .source = "Fig 5.1",
                        .truth = 2.66,
                        .target_absolute = 0.05},
                       {.id = "beside",
                        .name = "beside",
                        .estimate = {1.0, 0.0, 1},
                        .truth = 9.0,
                        .target_share = 0.1,
                        .has_interval = false}};
  return result;
}

TEST(Page, ASectionHasValueIntervalTruthAndVerdict) {
  const report::Section section = MakeSection(Example());
  report::CheckSection(section);
  ASSERT_EQ(section.comparisons.size(), 2u);
  EXPECT_EQ(section.comparisons[0].ours, "2.661");
  EXPECT_EQ(section.comparisons[0].interval, "2.659 .. 2.663");
  EXPECT_EQ(section.comparisons[0].target, "within 0.05 degrees");
  EXPECT_EQ(section.comparisons[0].met, true);
  // Listed for comparison: no target.
  EXPECT_FALSE(section.comparisons[1].met.has_value());
}

TEST(Page, AMissedTargetIsReported) {
  Result result = Example();
  result.quantities[0].estimate.value = 2.8;
  EXPECT_EQ(MakeSection(result).comparisons[0].met, false);
}

TEST(Rows, CsvHasALineForEachRow) {
  const std::string csv = FormatCsv({{.time_s = 0.5, .load_force_N = 2.0, .valve_open = true}});
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 2);
  EXPECT_NE(csv.find("0.500000,"), std::string::npos);
  EXPECT_NE(csv.find(",2.0000,1"), std::string::npos);
}

TEST(Rows, ARunIsReadFromAnInstantOnAndItsClockStartsThere) {
  types::Run run;
  run.name = "test";
  run.time_s = Eigen::Vector3d(10.0, 11.0, 12.0);
  run.signals[types::Signal::kPosition] = Eigen::Vector3d(1.0, 2.0, 3.0);
  run.signals[types::Signal::kMotorPosition] = Eigen::Vector3d(100.0, 200.0, 300.0);
  EXPECT_THROW((void)RowsOfRun(run, 0.0), std::invalid_argument);  // no current
  run.signals[types::Signal::kMotorCurrent] = Eigen::Vector3d::Zero();
  const Recording rows = RowsOfRun(run, 10.5);
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_NEAR(rows[0].time_s, 0.5, 1e-12);
  EXPECT_EQ(rows[1].motor_angle_rad, 300.0);
}

}  // namespace
}  // namespace sinew::experiment
